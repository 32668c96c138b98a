// What the test programs of tests/gen/cpp_programs.py share: values as text, to and from the structs that `roslet gen cpp`
// makes, and commands by line. Values go field by field through the members' names, not through the generated code.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>

#include "roslet/message.hpp"

// The fields of a struct in the order of its definition; generated for every message: `each(Visitor&, T&)`.
template <class T>
struct Fields;

// Reads values from a text into members, or appends members to a text.
class Visitor {
public:
    const char* given = nullptr;
    std::string made;

    template <class T>
    void operator()(T& value) {
        if constexpr (std::is_arithmetic_v<T>) {
            number(value);
        } else {
            Fields<T>::each(*this, value);
        }
    }
    template <std::size_t N>
    void operator()(roslet::String<N>& text) {
        characters(text, 1);
    }
    template <std::size_t N>
    void operator()(roslet::WString<N>& text) {
        characters(text, 2);
    }
    template <class T, std::size_t N>
    void operator()(roslet::Array<T, N>& values) {
        for (T& value : values) {
            (*this)(value);
        }
    }
    template <class T, std::size_t N>
    void operator()(roslet::Sequence<T, N>& values) {
        std::uint32_t size = static_cast<std::uint32_t>(values.size());
        number(size);
        if (!values.resize(size)) {
            std::abort();
        }
        for (T& value : values) {
            (*this)(value);
        }
    }
    void operator()(roslet::Time& time) {
        number(time.sec);
        number(time.nsec);
    }
    void operator()(roslet::Duration& duration) {
        number(duration.sec);
        number(duration.nsec);
    }

private:
    void number(bool& value) {
        std::uint8_t plain = value;
        integer(plain);
        value = plain != 0;
    }
    void number(float& value) { bits<std::uint32_t>(value); }
    void number(double& value) { bits<std::uint64_t>(value); }
    template <class T>
    void number(T& value) {
        integer(value);
    }

    template <class Bits, class T>
    void bits(T& value) {
        Bits plain;
        std::memcpy(&plain, &value, sizeof plain);
        integer(plain);
        std::memcpy(&value, &plain, sizeof plain);
    }

    template <class T>
    void integer(T& value) {
        if (given != nullptr) {
            char* end = nullptr;
            value = std::is_signed_v<T> ? static_cast<T>(std::strtoll(given, &end, 10))
                                        : static_cast<T>(std::strtoull(given, &end, 10));
            if (end == given) {
                std::abort();
            }
            given = end;
        } else if (std::is_signed_v<T>) {
            made += ' ' + std::to_string(static_cast<long long>(value));
        } else {
            made += ' ' + std::to_string(static_cast<unsigned long long>(value));
        }
    }

    // "x" and the units in hexadecimal.
    template <class Text>
    void characters(Text& text, int width) {
        if (given == nullptr) {
            made += " x";
            for (auto unit : text) {
                char shown[8];
                std::snprintf(shown, sizeof shown, "%0*x", 2 * width,
                              width == 1 ? static_cast<unsigned>(static_cast<unsigned char>(unit)) : static_cast<unsigned>(unit));
                made += shown;
            }
            return;
        }
        given += std::strspn(given, " ") + 1;
        std::size_t size = std::strspn(given, "0123456789abcdef") / (2U * static_cast<unsigned>(width));
        if (!text.resize(size)) {
            std::abort();
        }
        for (std::size_t index = 0; index < size; ++index) {
            const std::string digits(given, 2U * static_cast<unsigned>(width));
            text.data()[index] = static_cast<std::decay_t<decltype(text.data()[0])>>(std::strtoul(digits.c_str(), nullptr, 16));
            given += digits.size();
        }
    }
};

// What a program can do with a type.
struct Row {
    const char* type_name;
    const char* identity;  // MD5 sum or type hash
    const char* definition;
    std::size_t max_serialized_size;
    const char* (*field_name)(std::size_t);
    void* (*make)();
    void (*destroy)(void*);
    roslet::Result (*serialize)(const void*, roslet::Span<std::uint8_t>);
    roslet::Result (*deserialize)(void*, roslet::Span<const std::uint8_t>);
    void (*visit)(Visitor&, void*);
};

template <class T>
constexpr Row row(const char* identity) {
    return {T::type_name,
            identity,
            T::definition,
            T::max_serialized_size,
            T::field_name,
            []() -> void* { return new T{}; },
            [](void* message) { delete static_cast<T*>(message); },
            [](const void* message, roslet::Span<std::uint8_t> buffer) { return static_cast<const T*>(message)->serialize(buffer); },
            [](void* message, roslet::Span<const std::uint8_t> buffer) { return static_cast<T*>(message)->deserialize(buffer); },
            [](Visitor& visitor, void* message) { visitor(*static_cast<T*>(message)); }};
}

using Octets = std::unique_ptr<std::uint8_t[]>;

inline void print_result(const Row& row, roslet::Result result) {
    std::printf("%s %s %zu", roslet::name(result.error), row.field_name(result.field)[0] ? row.field_name(result.field) : "-",
                result.size);
}

// Lengths that are too short (all of the first 200, then some), in blocks of just that size so that a sanitizer sees a step
// outside: the first complaint, or "ok".
inline void cut(const Row& row, void* message, const std::uint8_t* octets, std::size_t size) {
    for (std::size_t length = 0; length < size; length += length < 200 ? 1 : 61) {
        Octets block(new std::uint8_t[length]);
        roslet::Result result = row.serialize(message, {block.get(), length});
        if (result.error != roslet::Error::buffer_too_small || result.size > length) {
            std::printf("serialize %zu ", length);
            return print_result(row, result);
        }
        void* other = row.make();
        std::memcpy(block.get(), octets, length);
        result = row.deserialize(other, {block.get(), length});
        row.destroy(other);
        if (result.error != roslet::Error::truncated || result.size > length) {
            std::printf("deserialize %zu ", length);
            return print_result(row, result);
        }
    }
    std::printf("ok");
}

// Commands, each a line and answered with one:
//   facts TYPE            type name, MD5 sum or hash, max_serialized_size, definition in hexadecimal
//   default TYPE          the values of a new message
//   write TYPE VALUES     result and octets
//   read TYPE OCTETS      result and values
//   room TYPE SIZE VALUES the result of a buffer of so many octets
//   cut TYPE VALUES       whether shorter buffers are refused
inline int serve(const Row* rows) {
    std::string line;
    for (int c; (c = std::getchar()) != EOF;) {
        if (c != '\n') {
            line += static_cast<char>(c);
            continue;
        }
        const std::size_t space = line.find(' ');
        char* rest = nullptr;
        const Row& row = rows[std::strtoul(line.c_str() + space, &rest, 10)];
        const std::string command = line.substr(0, space);
        void* message = row.make();
        Visitor visitor;
        if (command == "facts") {
            std::printf("%s %s %zu x", row.type_name, row.identity, row.max_serialized_size);
            for (const char* at = row.definition; *at != 0; ++at) {
                std::printf("%02x", static_cast<unsigned>(static_cast<unsigned char>(*at)));
            }
        } else if (command == "default") {
            row.visit(visitor, message);
            std::printf("%s", visitor.made.c_str());
        } else if (command == "read") {
            rest += std::strspn(rest, " ");
            const std::size_t size = std::strlen(rest) / 2;
            Octets octets(new std::uint8_t[size]);
            for (std::size_t index = 0; index < size; ++index) {
                const char digits[3] = {rest[2 * index], rest[2 * index + 1], 0};
                octets[index] = static_cast<std::uint8_t>(std::strtoul(digits, nullptr, 16));
            }
            print_result(row, row.deserialize(message, {octets.get(), size}));
            row.visit(visitor, message);
            std::printf("%s", visitor.made.c_str());
        } else if (command == "room") {
            const std::size_t size = std::strtoul(rest, &rest, 10);
            Octets octets(new std::uint8_t[size]);
            visitor.given = rest;
            row.visit(visitor, message);
            print_result(row, row.serialize(message, {octets.get(), size}));
        } else {
            visitor.given = rest;
            row.visit(visitor, message);
            Octets large(new std::uint8_t[1 << 20]);
            std::memset(large.get(), 0xA5, 1 << 20);
            const std::size_t size = row.serialize(message, {large.get(), 1 << 20}).size;
            if (command == "cut") {
                cut(row, message, large.get(), size);
            } else {
                Octets octets(new std::uint8_t[size]);
                std::memset(octets.get(), 0xA5, size);
                print_result(row, row.serialize(message, {octets.get(), size}));
                std::printf(" x");
                for (std::size_t index = 0; index < size; ++index) {
                    std::printf("%02x", static_cast<unsigned>(octets[index]));
                }
            }
        }
        row.destroy(message);
        std::printf("\n");
        std::fflush(stdout);
        line.clear();
    }
    return 0;
}
