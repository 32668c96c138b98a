// A target for libFuzzer: the headers that `roslet gen cpp` makes. The first octet and the second choose the type. Invariant:
// what is read within its bounds can be written in at most max_serialized_size octets, and reads again as what writes the same;
// and nothing steps outside the octets given, which the sanitizers see.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "roslet/message.hpp"

namespace {

using Octets = std::unique_ptr<std::uint8_t[]>;

void require(bool condition, const char* type, const char* what) {
    if (!condition) {
        std::fprintf(stderr, "%s: %s\n", type, what);
        std::abort();
    }
}

template <class T>
void judge(const std::uint8_t* data, std::size_t size) {
    // The largest are made once; what an earlier input left in them must not matter.
    static T* const message = new T;
    static T* const again = new T;
    static Octets first(new std::uint8_t[T::max_serialized_size]);
    const roslet::Result read = message->deserialize({data, size});
    require(read.size <= size, T::type_name, "read beyond the end");
    require(bool(read) || read.field == roslet::no_field || read.field < T::field_count, T::type_name, "no such field");
    // After an error, too, every field is within its bounds.
    const std::size_t room = T::max_serialized_size;
    const roslet::Result written = message->serialize({first.get(), room});
    require(bool(written), T::type_name, "what was read cannot be written");
    if (!read) {
        return;
    }
    Octets exact(new std::uint8_t[written.size]);
    std::memcpy(exact.get(), first.get(), written.size);
    require(again->deserialize({exact.get(), written.size}).size == written.size, T::type_name, "what was written cannot be read");
    Octets second(new std::uint8_t[written.size]);
    require(again->serialize({second.get(), written.size}).size == written.size, T::type_name, "the second is of another size");
    require(std::memcmp(second.get(), exact.get(), written.size) == 0, T::type_name, "the second is another");
}

using Judge = void (*)(const std::uint8_t*, std::size_t);

}  // namespace

#include "types.inc"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 2) {
        return 0;
    }
    constexpr std::size_t count = sizeof judges / sizeof *judges;
    // A copy of just these octets, so that a step outside is seen.
    Octets octets(new std::uint8_t[size - 2]);
    std::memcpy(octets.get(), data + 2, size - 2);
    judges[(static_cast<std::size_t>(data[0]) << 8 | data[1]) % count](octets.get(), size - 2);
    return 0;
}
