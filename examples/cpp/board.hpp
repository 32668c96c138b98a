// The part that would run on a board: publishes a Coordinate that moves, and checks what comes back. It calls nothing but the
// function that it was given to send with; whoever has octets for it calls `receive`.
#pragma once

#ifdef BOARD_ROS1
#include "mros_comm_measure/Coordinate.hpp"
using Coordinate = mros_comm_measure::Coordinate;
#else
#include "mros_comm_measure/msg/Coordinate.hpp"
using Coordinate = mros_comm_measure::msg::Coordinate;
#endif

class Board {
public:
    /// Sends the octets of a message; false if it could not.
    using Send = bool (*)(void* context, const std::uint8_t* octets, std::size_t size);

    constexpr Board(Send send, void* context) : send_(send), context_(context) {}

    /// Send the next message, at a time in nanoseconds since the epoch.
    bool publish(std::int64_t now) {
        ++sent_;
        message_ = position(sent_);
        message_.time = decltype(message_.time)::from_nanoseconds(now);
        const roslet::Result result = message_.serialize(buffer_);
        return result && send_(context_, buffer_, result.size);
    }

    /// Take the octets of a message that arrived; the error is roslet::Error::none and `field` empty if all is well.
    struct Heard {
        roslet::Error error;
        const char* field;
        std::int64_t round_trip;  ///< nanoseconds
    };
    Heard receive(const std::uint8_t* octets, std::size_t size, std::int64_t now) {
        const roslet::Result result = message_.deserialize({octets, size});
        if (!result) {
            return {result.error, Coordinate::field_name(result.field), 0};
        }
        ++heard_;
        const Coordinate expected = position(heard_);
        if (message_.x != expected.x || message_.y != expected.y || message_.z != expected.z) {
            ++wrong_;
        }
        const auto arrived = decltype(message_.time)::from_nanoseconds(now);
        return {roslet::Error::none, "", (arrived - message_.time).nanoseconds()};
    }

    const Coordinate& message() const { return message_; }
    unsigned heard() const { return heard_; }
    unsigned wrong() const { return wrong_; }

private:
    /// Where the point is in message `number`.
    static Coordinate position(unsigned number) {
        Coordinate here;
        here.x = static_cast<float>(0.1 * number);
        here.y = static_cast<float>(10.03 * number);
        here.z = static_cast<float>(3.003 * number);
        return here;
    }

    Send send_;
    void* context_;
    Coordinate message_{};
    std::uint8_t buffer_[Coordinate::max_serialized_size] = {};
    unsigned sent_ = 0;
    unsigned heard_ = 0;
    unsigned wrong_ = 0;
};
