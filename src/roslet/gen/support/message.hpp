// What the headers that `roslet gen cpp` writes stand on. Part of roslet (Apache License 2.0); do not edit.
//
// Freestanding C++17 for GCC and Clang: no heap, no exceptions, no RTTI, no global state, no library to link but memcpy and
// memset. Nothing here reads or writes outside the span that it was given.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <new>
#include <type_traits>

namespace roslet {

/// Why a message was not serialized or deserialized.
enum class Error : std::uint8_t {
    none,               ///< it was
    buffer_too_small,   ///< serialize: the span ends before the field does
    truncated,          ///< deserialize: the octets end before the field does
    too_long,           ///< deserialize: more elements or octets than the field's bound
    not_a_character,    ///< deserialize: a unit of a wide string that is beyond 16 bits
    bad_encapsulation,  ///< deserialize: the header is not that of plain CDR version 1
};

/// The error's name.
constexpr const char* name(Error error) noexcept {
    switch (error) {
        case Error::none: return "none";
        case Error::buffer_too_small: return "buffer_too_small";
        case Error::truncated: return "truncated";
        case Error::too_long: return "too_long";
        case Error::not_a_character: return "not_a_character";
        case Error::bad_encapsulation: return "bad_encapsulation";
    }
    return "unknown";
}

/// The number of a field in a result that concerns none.
inline constexpr std::uint16_t no_field = 0xFFFF;

/// What serialize and deserialize return; true if all went well.
struct [[nodiscard]] Result {
    Error error;
    std::uint16_t field;  ///< of an error: the number of the field; the message's `field_name(field)` is its name
    std::size_t size;     ///< octets written or read; of an error: those before the trouble

    constexpr explicit operator bool() const noexcept { return error == Error::none; }
};

/// A pointer and a number of elements.
template <class T>
class Span {
public:
    constexpr Span() noexcept = default;
    constexpr Span(T* data, std::size_t size) noexcept : data_(data), size_(size) {}
    template <std::size_t N>
    constexpr Span(T (&array)[N]) noexcept : data_(array), size_(N) {}
    /// A span of const elements from one of others.
    template <class U, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
    constexpr Span(Span<U> other) noexcept : data_(other.data()), size_(other.size()) {}

    constexpr T* data() const noexcept { return data_; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr T* begin() const noexcept { return data_; }
    constexpr T* end() const noexcept { return data_ + size_; }
    constexpr T& operator[](std::size_t index) const noexcept { return data_[index]; }

private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

namespace detail {

/// The smallest unsigned integer that can count to N.
template <std::size_t N>
using Count = std::conditional_t<(N <= 0xFF), std::uint8_t, std::conditional_t<(N <= 0xFFFF), std::uint16_t, std::uint32_t>>;

/// Text of at most N characters, and behind them a zero.
template <class Char, std::size_t N>
class Text {
public:
    constexpr Text() noexcept = default;

    /// From a literal, which must fit; up to its first zero.
    template <std::size_t M>
    constexpr Text(const Char (&literal)[M]) noexcept {
        static_assert(M <= N + 1, "the text is longer than the string's bound");
        while (size_ + 1U < M && literal[size_] != Char{}) {
            characters_[size_] = literal[size_];
            ++size_;
        }
    }

    /// The most characters that it holds.
    static constexpr std::size_t capacity() noexcept { return N; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr const Char* c_str() const noexcept { return characters_; }
    constexpr Char* data() noexcept { return characters_; }
    constexpr const Char* data() const noexcept { return characters_; }
    constexpr const Char* begin() const noexcept { return characters_; }
    constexpr const Char* end() const noexcept { return characters_ + size_; }
    constexpr Char operator[](std::size_t index) const noexcept { return characters_[index]; }

    /// Set to `size` characters; false, and nothing changes, if they do not fit.
    constexpr bool assign(const Char* text, std::size_t size) noexcept {
        if (size > N) {
            return false;
        }
        for (std::size_t index = 0; index < size; ++index) {
            characters_[index] = text[index];
        }
        return resize(size);
    }

    /// Set to the text that ends with a zero; false, and nothing changes, if it does not fit.
    constexpr bool assign(const Char* text) noexcept { return assign(text, length(text)); }

    /// Set the size and the zero behind it, for those who write to data(); false, and nothing changes, beyond the bound.
    constexpr bool resize(std::size_t size) noexcept {
        if (size > N) {
            return false;
        }
        size_ = static_cast<Count<N>>(size);
        characters_[size] = Char{};
        return true;
    }

    constexpr void clear() noexcept { resize(0); }

    /// Whether it is the text that ends with a zero.
    constexpr bool operator==(const Char* text) const noexcept { return equals(text, length(text)); }
    constexpr bool operator!=(const Char* text) const noexcept { return !(*this == text); }
    template <std::size_t M>
    constexpr bool operator==(const Text<Char, M>& other) const noexcept {
        return equals(other.data(), other.size());
    }
    template <std::size_t M>
    constexpr bool operator!=(const Text<Char, M>& other) const noexcept {
        return !(*this == other);
    }

private:
    constexpr bool equals(const Char* text, std::size_t size) const noexcept {
        if (size != size_) {
            return false;
        }
        for (std::size_t index = 0; index < size; ++index) {
            if (characters_[index] != text[index]) {
                return false;
            }
        }
        return true;
    }

    static constexpr std::size_t length(const Char* text) noexcept {
        std::size_t size = 0;
        while (text[size] != Char{}) {
            ++size;
        }
        return size;
    }

    Count<N> size_ = 0;
    Char characters_[N + 1] = {};
};

}  // namespace detail

/// A string of at most N octets; messages hold UTF-8, which nobody checks here.
template <std::size_t N>
using String = detail::Text<char, N>;

/// A wide string of at most N units of UTF-16.
template <std::size_t N>
using WString = detail::Text<char16_t, N>;

/// An array of exactly N elements.
template <class T, std::size_t N>
struct Array {
    T items[N];

    static constexpr std::size_t size() noexcept { return N; }
    constexpr T* data() noexcept { return items; }
    constexpr const T* data() const noexcept { return items; }
    constexpr T* begin() noexcept { return items; }
    constexpr const T* begin() const noexcept { return items; }
    constexpr T* end() noexcept { return items + N; }
    constexpr const T* end() const noexcept { return items + N; }
    constexpr T& operator[](std::size_t index) noexcept { return items[index]; }
    constexpr const T& operator[](std::size_t index) const noexcept { return items[index]; }
};

/// An array of no elements, which ROS 1 allows.
template <class T>
struct Array<T, 0> {
    static constexpr std::size_t size() noexcept { return 0; }
    constexpr T* data() const noexcept { return nullptr; }
    constexpr T* begin() const noexcept { return nullptr; }
    constexpr T* end() const noexcept { return nullptr; }
};

/// At most N elements. Storage behind the last one is not initialized, so that a static one costs no image of its contents.
template <class T, std::size_t N>
class Sequence {
    static_assert(std::is_trivially_copyable_v<T>, "elements are copied with their storage");

public:
    constexpr Sequence() noexcept = default;

    /// From elements, which must fit.
    template <class First, class = std::enable_if_t<!std::is_same_v<First, Sequence>>>
    constexpr explicit Sequence(const First& first) noexcept : size_(1), storage_(first) {}
    template <class First, class Second, class... More>
    constexpr Sequence(const First& first, const Second& second, const More&... more) noexcept
        : size_(2 + sizeof...(More)), storage_(first, second, more...) {
        static_assert(2 + sizeof...(More) <= N, "more elements than the sequence's bound");
    }

    /// The most elements that it holds.
    static constexpr std::size_t capacity() noexcept { return N; }
    constexpr std::size_t size() const noexcept { return size_; }
    constexpr bool empty() const noexcept { return size_ == 0; }
    constexpr T* data() noexcept { return storage_.items; }
    constexpr const T* data() const noexcept { return storage_.items; }
    constexpr T* begin() noexcept { return storage_.items; }
    constexpr const T* begin() const noexcept { return storage_.items; }
    constexpr T* end() noexcept { return storage_.items + size_; }
    constexpr const T* end() const noexcept { return storage_.items + size_; }
    constexpr T& operator[](std::size_t index) noexcept { return storage_.items[index]; }
    constexpr const T& operator[](std::size_t index) const noexcept { return storage_.items[index]; }

    /// Append; false, and nothing changes, if it is full.
    bool push_back(const T& value) noexcept {
        if (size_ >= N) {
            return false;
        }
        ::new (static_cast<void*>(storage_.items + size_)) T(value);
        ++size_;
        return true;
    }

    /// Set the size; new elements have their defaults. False, and nothing changes, beyond the bound.
    bool resize(std::size_t size) noexcept {
        if (size > N) {
            return false;
        }
        for (std::size_t index = size_; index < size; ++index) {
            ::new (static_cast<void*>(storage_.items + index)) T{};
        }
        size_ = static_cast<detail::Count<N>>(size);
        return true;
    }

    /// Set to `size` elements; false, and nothing changes, if they do not fit.
    bool assign(const T* elements, std::size_t size) noexcept {
        if (size > N) {
            return false;
        }
        for (std::size_t index = 0; index < size; ++index) {
            ::new (static_cast<void*>(storage_.items + index)) T(elements[index]);
        }
        size_ = static_cast<detail::Count<N>>(size);
        return true;
    }

    /// `size` elements to be written by the caller: new ones are not initialized. Null, and nothing changes, beyond the
    /// bound.
    T* overwrite(std::size_t size) noexcept {
        static_assert(std::is_arithmetic_v<T>, "an element that is no number has defaults: resize");
        if (size > N) {
            return nullptr;
        }
        size_ = static_cast<detail::Count<N>>(size);
        return storage_.items;
    }

    constexpr void clear() noexcept { size_ = 0; }

private:
    union Storage {
        constexpr Storage() noexcept : none() {}
        template <class... Values>
        constexpr explicit Storage(const Values&... values) noexcept : items{static_cast<T>(values)...} {}

        char none;
        T items[N];
    };

    detail::Count<N> size_ = 0;
    Storage storage_{};
};

/// Arithmetic of times and durations. T is one if it has `Difference`, its type of durations, and the pair nanoseconds()
/// and from_nanoseconds(). Results beyond what the type can hold are its nearest value.
namespace stamps {

inline constexpr std::int64_t second = 1000000000;

/// The sum, or the nearest value that there is.
constexpr std::int64_t sum(std::int64_t a, std::int64_t b) noexcept {
    std::int64_t result = 0;
    if (__builtin_add_overflow(a, b, &result)) {
        return a < 0 ? std::numeric_limits<std::int64_t>::min() : std::numeric_limits<std::int64_t>::max();
    }
    return result;
}

/// A time or duration of so many nanoseconds, its second member in [0, 1 s); or the nearest that T can hold.
template <class T, class Seconds, class Nanoseconds>
constexpr T split(std::int64_t value) noexcept {
    constexpr std::int64_t least = std::numeric_limits<Seconds>::min();
    constexpr std::int64_t most = std::numeric_limits<Seconds>::max();
    std::int64_t seconds = value / second;
    std::int64_t rest = value % second;
    if (rest < 0) {
        rest += second;
        --seconds;
    }
    if (seconds < least) {
        return T{static_cast<Seconds>(least), 0};
    }
    if (seconds > most) {
        return T{static_cast<Seconds>(most), static_cast<Nanoseconds>(second - 1)};
    }
    return T{static_cast<Seconds>(seconds), static_cast<Nanoseconds>(rest)};
}

template <class T, class Difference = typename T::Difference>
constexpr T operator+(const T& a, const Difference& b) noexcept {
    return T::from_nanoseconds(sum(a.nanoseconds(), b.nanoseconds()));
}

/// A duration less another, the duration between two times, or a time less a duration.
template <class T, class U, class Difference = typename T::Difference,
          class = std::enable_if_t<std::is_same_v<U, T> || std::is_same_v<U, Difference>>>
constexpr auto operator-(const T& a, const U& b) noexcept {
    using Type = std::conditional_t<std::is_same_v<U, T>, Difference, T>;
    return Type::from_nanoseconds(sum(a.nanoseconds(), -b.nanoseconds()));
}

template <class T, class = std::enable_if_t<std::is_same_v<typename T::Difference, T>>>
constexpr T operator-(const T& a) noexcept {
    return T::from_nanoseconds(-a.nanoseconds());
}

template <class T, class Difference = typename T::Difference>
constexpr T& operator+=(T& a, const Difference& b) noexcept {
    return a = a + b;
}

template <class T, class Difference = typename T::Difference>
constexpr T& operator-=(T& a, const Difference& b) noexcept {
    return a = a - b;
}

template <class T, class = std::enable_if_t<std::is_same_v<typename T::Difference, T>>>
constexpr T operator*(const T& a, std::int64_t factor) noexcept {
    std::int64_t result = 0;
    if (__builtin_mul_overflow(a.nanoseconds(), factor, &result)) {
        const bool negative = (a.nanoseconds() < 0) != (factor < 0);
        result = negative ? std::numeric_limits<std::int64_t>::min() : std::numeric_limits<std::int64_t>::max();
    }
    return T::from_nanoseconds(result);
}

template <class T, class = typename T::Difference>
constexpr bool operator==(const T& a, const T& b) noexcept {
    return a.nanoseconds() == b.nanoseconds();
}
template <class T, class = typename T::Difference>
constexpr bool operator!=(const T& a, const T& b) noexcept {
    return !(a == b);
}
template <class T, class = typename T::Difference>
constexpr bool operator<(const T& a, const T& b) noexcept {
    return a.nanoseconds() < b.nanoseconds();
}
template <class T, class = typename T::Difference>
constexpr bool operator>(const T& a, const T& b) noexcept {
    return b < a;
}
template <class T, class = typename T::Difference>
constexpr bool operator<=(const T& a, const T& b) noexcept {
    return !(b < a);
}
template <class T, class = typename T::Difference>
constexpr bool operator>=(const T& a, const T& b) noexcept {
    return !(a < b);
}

}  // namespace stamps

/// A duration of ROS 1; `nsec` is at least 0 in what arithmetic makes.
struct Duration {
    std::int32_t sec = 0;
    std::int32_t nsec = 0;

    using Difference = Duration;
    constexpr std::int64_t nanoseconds() const noexcept { return sec * stamps::second + nsec; }
    static constexpr Duration from_nanoseconds(std::int64_t value) noexcept {
        return stamps::split<Duration, std::int32_t, std::int32_t>(value);
    }
};

/// A time of ROS 1, since the epoch.
struct Time {
    std::uint32_t sec = 0;
    std::uint32_t nsec = 0;

    using Difference = Duration;
    constexpr std::int64_t nanoseconds() const noexcept { return sec * stamps::second + nsec; }
    static constexpr Time from_nanoseconds(std::int64_t value) noexcept {
        return stamps::split<Time, std::uint32_t, std::uint32_t>(value);
    }
};

using stamps::operator+;
using stamps::operator-;
using stamps::operator*;
using stamps::operator+=;
using stamps::operator-=;
using stamps::operator==;
using stamps::operator!=;
using stamps::operator<;
using stamps::operator>;
using stamps::operator<=;
using stamps::operator>=;

// From here on it is what generated code calls.

/// Fields that lie at known distances and are checked at once: where each ends, counted from the first octet.
struct Run {
    const std::uint16_t* ends;  ///< of all fields but the last, which ends with the run
    std::uint32_t size;
    std::uint16_t field;  ///< the number of the first field; the others follow it
    std::uint16_t count;  ///< fields
    std::uint8_t align;   ///< the position before is first made a multiple of it
};

/// The run of `Size` octets that begins with field `Field`; `Ends` as in Run.
template <std::size_t Align, std::uint16_t Field, std::uint32_t Size, std::uint16_t... Ends>
struct RunOf {
    static constexpr std::uint16_t ends[sizeof...(Ends) + 1] = {Ends..., 0};
    static constexpr Run value{ends, Size, Field, sizeof...(Ends) + 1, Align};
};
template <std::size_t Align, std::uint16_t Field, std::uint32_t Size, std::uint16_t... Ends>
inline constexpr const Run& run = RunOf<Align, Field, Size, Ends...>::value;

namespace detail {

inline constexpr bool big_endian = __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__;

constexpr std::uint8_t swapped(std::uint8_t value) noexcept { return value; }
constexpr std::uint16_t swapped(std::uint16_t value) noexcept { return __builtin_bswap16(value); }
constexpr std::uint32_t swapped(std::uint32_t value) noexcept { return __builtin_bswap32(value); }
constexpr std::uint64_t swapped(std::uint64_t value) noexcept { return __builtin_bswap64(value); }

template <class T>
using Bits = std::conditional_t<
    sizeof(T) == 1, std::uint8_t,
    std::conditional_t<sizeof(T) == 2, std::uint16_t, std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;

/// Write a number at an address of any alignment.
template <class T>
inline void store(std::uint8_t* to, T value, bool swap) noexcept {
    Bits<T> bits;
    __builtin_memcpy(&bits, &value, sizeof bits);
    if (swap) {
        bits = swapped(bits);
    }
    __builtin_memcpy(to, &bits, sizeof bits);
}

/// Read a number from an address of any alignment. A bool is true for every octet but 0.
template <class T>
inline T load(const std::uint8_t* from, bool swap) noexcept {
    if constexpr (std::is_same_v<T, bool>) {
        return *from != 0;
    } else {
        Bits<T> bits;
        __builtin_memcpy(&bits, from, sizeof bits);
        if (swap) {
            bits = swapped(bits);
        }
        T value;
        __builtin_memcpy(&value, &bits, sizeof value);
        return value;
    }
}

/// What Writer and Reader share: a place in a span, and the first error.
template <class Byte, Error Short>
class Cursor {
public:
    Cursor(Byte* data, std::size_t size) noexcept : begin_(data), at_(data), end_(data + size) {}

    /// The first octet of a run, behind which the place is then; null if it does not fit.
    Byte* run(const Run& run) noexcept {
        Byte* const first = advance(run.align, run.size);
        if (first == nullptr) {
            std::size_t index = 0;
            while (index + 1U < run.count && run.ends[index] <= left_) {
                ++index;
            }
            fail(Short, static_cast<std::uint16_t>(run.field + index));
        }
        return first;
    }

    Result result() const noexcept { return {error_, field_, static_cast<std::size_t>(at_ - begin_)}; }

protected:
    /// As `run`, for `size` octets of one field.
    Byte* take(std::size_t align, std::size_t size, std::uint16_t field) noexcept {
        Byte* const first = advance(align, size);
        if (first == nullptr) {
            fail(Short, field);
        }
        return first;
    }

    bool fail(Error error, std::uint16_t field) noexcept {
        error_ = error;
        field_ = field;
        return false;
    }

    std::size_t left() const noexcept { return static_cast<std::size_t>(end_ - at_); }

private:
    /// Align and move on by `size`; the place before that, or null if it does not fit: then `left_` is what would.
    Byte* advance(std::size_t align, std::size_t size) noexcept {
        const std::size_t padding = static_cast<std::size_t>(begin_ - at_) & (align - 1);
        if (padding > left()) {
            left_ = 0;
            return nullptr;
        }
        if (size > left() - padding) {
            left_ = left() - padding;
            return nullptr;
        }
        if constexpr (!std::is_const_v<Byte>) {
            for (std::size_t index = 0; index < padding; ++index) {
                at_[index] = 0;
            }
        }
        Byte* const first = at_ + padding;
        at_ = first + size;
        return first;
    }

    Byte* const begin_;
    Byte* at_;
    Byte* const end_;
    std::size_t left_ = 0;
    Error error_ = Error::none;
    std::uint16_t field_ = no_field;
};

}  // namespace detail

/// ROS 1: little endian, nothing aligned, strings without a zero.
struct Ros1 {
    static constexpr std::size_t terminator = 0;
    static constexpr std::size_t alignment = 1;
};

/// Plain CDR version 1 without its encapsulation header; positions count from the first octet.
struct Cdr {
    static constexpr std::size_t terminator = 1;
    static constexpr std::size_t alignment = 8;
};

/// Writes octets, in little endian. Of what is variable it gets the place of the count, which lies in the run before.
template <class Encoding>
class Writer : public detail::Cursor<std::uint8_t, Error::buffer_too_small> {
    static constexpr bool swap = detail::big_endian;

public:
    explicit Writer(Span<std::uint8_t> buffer) noexcept : Cursor(buffer.data(), buffer.size()) {}

    template <class T>
    void value(std::uint8_t* to, const T& value) const noexcept {
        detail::store(to, value, swap);
    }

    template <class T, std::size_t N>
    void value(std::uint8_t* to, const Array<T, N>& values) const noexcept {
        copy(to, values.data(), N);
    }

    /// Zeros between two fields of a run.
    void padding(std::uint8_t* to, std::size_t size) const noexcept { __builtin_memset(to, 0, size); }

    template <std::size_t N>
    bool text(std::uint8_t* count, const String<N>& text, std::uint16_t field) noexcept {
        return octets(count, text.data(), text.size(), field);
    }

    template <std::size_t N>
    bool text(std::uint8_t* count, const WString<N>& text, std::uint16_t field) noexcept {
        return units(count, text.data(), text.size(), field);
    }

    template <class T, std::size_t N>
    bool numbers(std::uint8_t* count, const Sequence<T, N>& values, std::uint16_t field) noexcept {
        return elements(count, values.data(), values.size(), field);
    }

    /// The count of elements that follow one by one.
    template <class T, std::size_t N>
    bool count(std::uint8_t* count, const Sequence<T, N>& values, std::uint16_t) noexcept {
        value(count, static_cast<std::uint32_t>(values.size()));
        return true;
    }

private:
    bool octets(std::uint8_t* count, const char* text, std::size_t size, std::uint16_t field) noexcept {
        const std::size_t whole = size + Encoding::terminator;
        value(count, static_cast<std::uint32_t>(whole));
        std::uint8_t* const to = take(1, whole, field);
        if (to == nullptr) {
            return false;
        }
        __builtin_memcpy(to, text, whole);
        return true;
    }

    bool units(std::uint8_t* count, const char16_t* text, std::size_t size, std::uint16_t field) noexcept {
        value(count, static_cast<std::uint32_t>(size));
        std::uint8_t* const to = take(1, 4 * size, field);
        if (to == nullptr) {
            return false;
        }
        for (std::size_t index = 0; index < size; ++index) {
            value(to + 4 * index, static_cast<std::uint32_t>(text[index]));
        }
        return true;
    }

    template <class T>
    bool elements(std::uint8_t* count, const T* values, std::size_t size, std::uint16_t field) noexcept {
        value(count, static_cast<std::uint32_t>(size));
        if (size == 0) {
            return true;
        }
        constexpr std::size_t align = sizeof(T) < Encoding::alignment ? sizeof(T) : Encoding::alignment;
        std::uint8_t* const to = take(align, size * sizeof(T), field);
        if (to == nullptr) {
            return false;
        }
        copy(to, values, size);
        return true;
    }

    template <class T>
    void copy(std::uint8_t* to, const T* values, std::size_t size) const noexcept {
        if constexpr (swap && sizeof(T) > 1) {
            for (std::size_t index = 0; index < size; ++index) {
                value(to + index * sizeof(T), values[index]);
            }
        } else {
            __builtin_memcpy(to, values, size * sizeof(T));
        }
    }
};

/// Reads octets. Of what is variable it gets the place of the count, which it checks against the bound and the octets left.
template <class Encoding>
class Reader : public detail::Cursor<const std::uint8_t, Error::truncated> {
public:
    /// `big`: whether the octets are big endian, which ROS 1's never are.
    Reader(Span<const std::uint8_t> buffer, bool big) noexcept
        : Cursor(buffer.data(), buffer.size()), swap_(big != detail::big_endian) {}

    template <class T>
    void value(const std::uint8_t* from, T& value) const noexcept {
        value = detail::load<T>(from, swap());
    }

    template <class T, std::size_t N>
    void value(const std::uint8_t* from, Array<T, N>& values) const noexcept {
        copy(from, values.data(), N);
    }

    void padding(const std::uint8_t*, std::size_t) const noexcept {}

    template <std::size_t N>
    bool text(const std::uint8_t* count, String<N>& text, std::uint16_t field) noexcept {
        std::size_t size = 0;
        return octets(count, text.data(), N, size, field) && text.resize(size);
    }

    template <std::size_t N>
    bool text(const std::uint8_t* count, WString<N>& text, std::uint16_t field) noexcept {
        std::size_t size = 0;
        return units(count, text.data(), N, size, field) && text.resize(size);
    }

    template <class T, std::size_t N>
    bool numbers(const std::uint8_t* count, Sequence<T, N>& values, std::uint16_t field) noexcept {
        const std::size_t size = detail::load<std::uint32_t>(count, swap());
        const std::uint8_t* const from = elements(size, N, sizeof(T), field);
        if (from == nullptr) {
            return false;
        }
        copy(from, values.overwrite(size), size);
        return true;
    }

    /// The count of elements that follow one by one; makes room for them.
    template <class T, std::size_t N>
    bool count(const std::uint8_t* count, Sequence<T, N>& values, std::uint16_t field) noexcept {
        values.clear();
        if (!values.resize(detail::load<std::uint32_t>(count, swap()))) {
            return fail(Error::too_long, field);
        }
        return true;
    }

private:
    bool swap() const noexcept {
        if constexpr (std::is_same_v<Encoding, Ros1>) {
            return detail::big_endian;
        } else {
            return swap_;
        }
    }

    bool octets(const std::uint8_t* count, char* text, std::size_t bound, std::size_t& size,
                std::uint16_t field) noexcept {
        const std::size_t whole = detail::load<std::uint32_t>(count, swap());
        // Some write an empty string without the zero that is counted.
        size = whole < Encoding::terminator ? 0 : whole - Encoding::terminator;
        if (size > bound) {
            return fail(Error::too_long, field);
        }
        const std::uint8_t* const from = take(1, whole, field);
        if (from == nullptr) {
            return false;
        }
        __builtin_memcpy(text, from, size);
        return true;
    }

    bool units(const std::uint8_t* count, char16_t* text, std::size_t bound, std::size_t& size,
               std::uint16_t field) noexcept {
        size = detail::load<std::uint32_t>(count, swap());
        if (size > bound) {
            return fail(Error::too_long, field);
        }
        const std::uint8_t* const from = take(1, 4 * size, field);
        if (from == nullptr) {
            return false;
        }
        for (std::size_t index = 0; index < size; ++index) {
            const std::uint32_t unit = detail::load<std::uint32_t>(from + 4 * index, swap());
            if (unit > 0xFFFF) {
                return fail(Error::not_a_character, field);
            }
            text[index] = static_cast<char16_t>(unit);
        }
        return true;
    }

    /// Where `size` elements of `width` octets begin; null if they are too many for the bound or the octets left.
    const std::uint8_t* elements(std::size_t size, std::size_t bound, std::size_t width, std::uint16_t field) noexcept {
        if (size > bound) {
            fail(Error::too_long, field);
            return nullptr;
        }
        return take(size == 0 || width > Encoding::alignment ? 1 : width, size * width, field);
    }

    template <class T>
    void copy(const std::uint8_t* from, T* values, std::size_t size) const noexcept {
        if constexpr (sizeof(T) == 1 && !std::is_same_v<T, bool>) {
            __builtin_memcpy(values, from, size);
        } else {
            for (std::size_t index = 0; index < size; ++index) {
                values[index] = detail::load<T>(from + index * sizeof(T), swap());
            }
        }
    }

    bool swap_;
};

/// ROS 1: the octets of a message, as they stand behind their length in TCPROS.
namespace ros1 {

template <class Message>
inline Result serialize(const Message& message, Span<std::uint8_t> buffer) noexcept {
    Writer<Ros1> writer(buffer);
    Message::transfer(writer, message);
    return writer.result();
}

template <class Message>
inline Result deserialize(Message& message, Span<const std::uint8_t> buffer) noexcept {
    Reader<Ros1> reader(buffer, false);
    Message::transfer(reader, message);
    return reader.result();
}

}  // namespace ros1

/// ROS 2: an encapsulation header of four octets and the body in plain CDR version 1.
namespace cdr {

/// Octets of the encapsulation header; alignment counts from behind it.
inline constexpr std::size_t header_size = 4;

template <class Message>
inline Result serialize_body(const Message& message, Span<std::uint8_t> buffer) noexcept {
    Writer<Cdr> writer(buffer);
    Message::transfer(writer, message);
    return writer.result();
}

template <class Message>
inline Result deserialize_body(Message& message, Span<const std::uint8_t> buffer, bool big_endian) noexcept {
    Reader<Cdr> reader(buffer, big_endian);
    Message::transfer(reader, message);
    return reader.result();
}

template <class Message>
inline Result serialize(const Message& message, Span<std::uint8_t> buffer) noexcept {
    if (buffer.size() < header_size) {
        return {Error::buffer_too_small, no_field, 0};
    }
    std::uint8_t* const header = buffer.data();
    header[0] = 0;
    header[1] = 1;  // CDR_LE
    header[2] = 0;
    header[3] = 0;
    Result result = serialize_body(message, {header + header_size, buffer.size() - header_size});
    result.size += header_size;
    return result;
}

template <class Message>
inline Result deserialize(Message& message, Span<const std::uint8_t> buffer) noexcept {
    if (buffer.size() < header_size) {
        return {Error::truncated, no_field, 0};
    }
    const std::uint8_t* const header = buffer.data();
    if (header[0] != 0 || header[1] > 1) {
        return {Error::bad_encapsulation, no_field, 0};
    }
    Result result = deserialize_body(message, {header + header_size, buffer.size() - header_size}, header[1] == 0);
    result.size += header_size;
    return result;
}

}  // namespace cdr

}  // namespace roslet
