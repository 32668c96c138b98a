// What users write with the headers; test_cpp_headers.py compiles and runs it. It prints nothing if all is well.
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

#include "builtin_interfaces/msg/Duration.hpp"
#include "builtin_interfaces/msg/Time.hpp"
#include "geometry_msgs/msg/PoseArray.hpp"
#include "odd_msgs/msg/Odd.hpp"
#include "odd_msgs/srv/Ask.hpp"
#include "std_msgs/String.hpp"

#define CHECK(condition)                                              \
    do {                                                              \
        if (!(condition)) {                                           \
            std::printf("line %d: %s\n", __LINE__, #condition);       \
            std::exit(1);                                             \
        }                                                             \
    } while (false)

namespace {

using odd_msgs::msg::Odd;
using Rostime = roslet::Time;
using Rosduration = roslet::Duration;
namespace ros2 = builtin_interfaces::msg;

// Constants are constants.
static_assert(Odd::LOWEST == std::numeric_limits<std::int64_t>::min());
static_assert(Odd::LOW == std::numeric_limits<std::int32_t>::min());
static_assert(Odd::HIGHEST == std::numeric_limits<std::uint64_t>::max());
static_assert(Odd::TENTH == 0.1F);
static_assert(Odd::YES);
static_assert(std::is_same_v<decltype(Odd::TENTH), const float>);

// Names that are taken get an underscore; types are what the definition says.
static_assert(std::is_same_v<decltype(Odd::class_), std::int8_t>);
static_assert(std::is_same_v<decltype(Odd::new_), roslet::Sequence<std::uint8_t, 6>>);
static_assert(std::is_same_v<decltype(Odd::few), roslet::Sequence<roslet::String<5>, 3>>);
static_assert(std::is_same_v<decltype(Odd::definition_), roslet::String<600>>);
static_assert(std::is_same_v<decltype(Odd::transfer_), std::int32_t>);
static_assert(!std::is_convertible_v<int, decltype(Odd::new_)>);
static_assert(std::is_same_v<decltype(Odd::pair), roslet::Array<odd_msgs::msg::Nested, 2>>);
static_assert(std::is_same_v<odd_msgs::srv::Ask::Request, odd_msgs::srv::Ask_Request>);

// Messages can be copied as they lie, and be made at compile time, defaults and all.
static_assert(std::is_trivially_copyable_v<Odd>);
constexpr Odd odd;
static_assert(odd.names[1] == "two");
static_assert(odd.words[1] == "\u00e4" && odd.words.size() == 3);
static_assert(odd.pair[1].second == 2.5);
static_assert(odd.wide.size() == 7 && odd.wide[6] == u'\u20ac');
static_assert(!odd.flags[1] && odd.flags[2]);

void strings() {
    roslet::String<5> text("five");
    static_assert(decltype(text)::capacity() == 5);
    CHECK(text == "five" && text.size() == 4 && text.c_str()[4] == 0);
    CHECK(!text.assign("longer than five") && text == "five");
    CHECK(text.assign("12345") && text == "12345" && text != "1234");
    CHECK(text.assign("a\0b", 3) && text.size() == 3);
    CHECK(!text.resize(6) && text.resize(1) && text == "a");
    text = "new";
    CHECK(text == "new");
    CHECK((text == roslet::String<9>("new") && text != roslet::String<3>("old")));
    text.clear();
    CHECK(text.empty() && text == "");
}

void sequences() {
    roslet::Sequence<geometry_msgs::msg::Quaternion, 2> some;
    CHECK(some.empty() && some.capacity() == 2);
    CHECK(some.resize(1) && some[0].w == 1.0);
    CHECK(some.push_back({1, 2, 3, 4}) && some[1].z == 3.0);
    CHECK(!some.push_back({}) && !some.resize(3) && some.size() == 2);
    some.clear();
    CHECK(some.resize(2) && some[1].z == 0.0 && some[1].w == 1.0);
    const double values[] = {1, 2, 3};
    roslet::Sequence<double, 3> numbers{4.0};
    CHECK(numbers.size() == 1 && numbers[0] == 4.0);
    CHECK(numbers.assign(values, 3) && numbers[2] == 3.0);
    CHECK(!numbers.assign(values, 4) && numbers.overwrite(4) == nullptr && numbers.size() == 3);
    double sum = 0;
    for (double number : numbers) {
        sum += number;
    }
    CHECK(sum == 6.0);
    const roslet::Sequence<double, 3> copy = numbers;
    CHECK(copy.size() == 3 && copy[1] == 2.0);
}

void times() {
    constexpr Rostime early{1, 900000000};
    constexpr Rostime late{3, 100000000};
    static_assert((late - early).sec == 1 && (late - early).nsec == 200000000);
    static_assert((early - late).sec == -2 && (early - late).nsec == 800000000);
    static_assert(early + (late - early) == late && late - (late - early) == early);
    static_assert(early < late && late >= early && early != late);
    static_assert((Rostime{0, 0} - late == Rosduration{-4, 900000000}));
    static_assert((Rostime{0, 0} - Rosduration{1, 0} == Rostime{0, 0}));  // there is nothing before
    static_assert((Rostime{0xFFFFFFFF, 0} + Rosduration{5, 0} == Rostime{0xFFFFFFFF, 999999999}));
    static_assert((Rosduration{1, 500000000} * -3 == Rosduration{-5, 500000000}));
    static_assert((-Rosduration{1, 500000000}).nanoseconds() == -1500000000);
    static_assert(Rosduration{0x7FFFFFFF, 0} * 0x7FFFFFFFFFFF == (Rosduration{0x7FFFFFFF, 999999999}));
    static_assert(Rostime::from_nanoseconds(5000000001) == (Rostime{5, 1}));

    constexpr ros2::Time stamp{-5, 250000000};
    static_assert(stamp.nanoseconds() == -4750000000);
    static_assert((stamp + ros2::Duration{10, 0}).sec == 5);
    static_assert(std::is_same_v<decltype(stamp - stamp), ros2::Duration>);
    static_assert(std::is_same_v<decltype(stamp - ros2::Duration{}), ros2::Time>);
    ros2::Time moving = stamp;
    moving += ros2::Duration{5, 0};
    moving -= ros2::Duration{0, 250000000};
    CHECK(moving == (ros2::Time{0, 0}));
}

void errors() {
    geometry_msgs::msg::PoseArray poses;
    CHECK(poses.poses.resize(2));
    std::uint8_t buffer[geometry_msgs::msg::PoseArray::max_serialized_size];
    roslet::Result result = poses.serialize(buffer);
    CHECK(result && result.error == roslet::Error::none && result.size == 4 + 24 + 2 * 56);
    const std::size_t whole = result.size;

    result = poses.serialize({buffer, 95});
    CHECK(!result && result.error == roslet::Error::buffer_too_small);
    CHECK(std::string(poses.field_name(result.field)) == "poses[].position.y");
    result = poses.deserialize({buffer, whole - 1});
    CHECK(result.error == roslet::Error::truncated);
    CHECK(std::string(poses.field_name(result.field)) == "poses[].orientation.w");
    CHECK(std::string(roslet::name(result.error)) == "truncated");
    CHECK(poses.deserialize({buffer, whole}) && poses.poses.size() == 2);

    result = poses.deserialize(buffer);  // what is behind the message is left alone
    CHECK(result && result.size == whole);

    buffer[1] = 3;  // parameter lists
    result = poses.deserialize({buffer, whole});
    CHECK(result.error == roslet::Error::bad_encapsulation && result.field == roslet::no_field);
    CHECK(poses.field_name(result.field)[0] == 0);

    // Without the header, as a stack that writes it itself takes it.
    std::uint8_t body[geometry_msgs::msg::PoseArray::max_serialized_size];
    result = poses.serialize_body(body);
    CHECK(result && result.size == whole - roslet::cdr::header_size);
    CHECK(poses.deserialize_body({body, result.size}, false) && poses.poses.size() == 2);

    std_msgs::String text;  // of ROS 1, beside those of ROS 2
    CHECK(text.data.assign("hello"));
    result = text.serialize(buffer);
    CHECK(result && result.size == 9 && buffer[0] == 5 && buffer[4] == 'h');
}

}  // namespace

int main() {
    strings();
    sequences();
    times();
    errors();
}
