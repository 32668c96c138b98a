// The roscpp peer: a node that does what the lines on its standard input say and tells on its standard output what it saw.
// interop/ros1.py speaks the other side; rospy_peer.py understands the same lines.
//
//   advertise TYPE TOPIC LATCH        -> advertised TOPIC          publish TOPIC I SIZE   -> published TOPIC I
//   subscribers TOPIC                 -> subscribers TOPIC N       unadvertise TOPIC      -> unadvertised TOPIC
//   subscribe TYPE TOPIC SIZE HINT    -> subscribed TOPIC          then, each message: got TOPIC I ok|differs
//   publishers TOPIC                  -> publishers TOPIC N        unsubscribe TOPIC      -> unsubscribed TOPIC
//   serve NAME                        -> serving NAME              call NAME N FACTOR PERSISTENT -> called NAME ok|differs|failed
//   set NAME KIND VALUE               -> set NAME                  get NAME KIND          -> value NAME KIND TEXT | missing NAME
//   quit
//
// The I-th message of a type is the same in every peer: fill() here, samples.py in Python.
#include <mros_comm_measure/Coordinate.h>
#include <peer_msgs/Crowd.h>
#include <peer_msgs/Primitives.h>
#include <peer_msgs/Scale.h>
#include <peer_msgs/Stamps.h>
#include <peer_msgs/UserTypeTest.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>
#include <std_msgs/String.h>

#include <functional>
#include <iostream>
#include <map>
#include <mutex>
#include <sstream>

static const uint32_t EPOCH = 1700000000;
static std::mutex output_mutex;

static void tell(const std::string& line) {
  std::lock_guard<std::mutex> lock(output_mutex);
  std::cout << line << std::endl;
}

template <class... Parts> static void tell(const Parts&... parts) {
  std::ostringstream line;
  int count = 0;
  (void)std::initializer_list<int>{((line << (count++ ? " " : "") << parts), 0)...};
  tell(line.str());
}

// ---- the I-th message of each type

static ros::Time stamp(int i) { return ros::Time(EPOCH + i, 123456789); }

static void fill(std_msgs::Header& header, int i) {
  header.stamp = stamp(i);
  header.frame_id = "frame " + std::to_string(i);
}

static void fill(std_msgs::String& message, int i, long size) {
  if (size < 0) {
    message.data = "\xc5\xbelu\xc5\xa5ou\xc4\x8dk\xc3\xbd \xe6\x97\xa5\xe6\x9c\xac \xf0\x9f\x90\xa2 " + std::to_string(i);
    return;
  }
  message.data.resize(size);
  for (long k = 0; k < size; k++) message.data[k] = char('a' + (i + k) % 26);
}

static void fill(mros_comm_measure::Coordinate& message, int i, long = 0) {
  message.x = i + 0.5f;
  message.y = -2.0f * i - 0.25f;
  message.z = 1000.125f + i;
  message.time = stamp(i);
}

static void fill(peer_msgs::UserTypeTest& message, int i, long = 0) {
  message.name.first = "Grace " + std::to_string(i);
  message.name.last = std::string(i % 5, 'z');
  message.leds.red = i % 256;
  message.leds.green = 255 - i % 256;
  message.leds.blue = 7;
}

static void fill(peer_msgs::Crowd& message, int i, long size) {
  fill(message.header, i);
  message.people.resize(size);
  message.path.resize(size);
  for (long k = 0; k < size; k++) {
    fill(message.people[k], i + k);
    fill(message.path[k], i + k);
  }
  for (int k = 0; k < 3; k++) message.lamps[k].red = message.lamps[k].blue = i % 100 + k;
  for (int k = 0; k < 2; k++) message.guests[k].first = "guest " + std::to_string(k);
}

static void fill(peer_msgs::Stamps& message, int i, long size) {
  fill(message.header, i);
  message.stamp = ros::Time(0xffffffffu - i, 999999999);
  message.span = ros::Duration(-5 - i, 250000000);
  for (long k = 0; k < size; k++) message.stamps.push_back(stamp(i + k));
  message.spans[0] = ros::Duration(i, 1);
  message.spans[1] = ros::Duration(-1, 999999999);
}

static void fill(peer_msgs::Primitives& message, int i, long size) {
  message.truth = i % 2;
  message.i8 = -128 + i % 100;
  message.u8 = 255 - i % 100;
  message.i16 = -32768 + i;
  message.u16 = 65535 - i;
  message.i32 = -2147483647 - 1 + i;
  message.u32 = 4294967295u - i;
  message.i64 = -9223372036854775807LL - 1 + i;
  message.u64 = 18446744073709551615ULL - i;
  message.f32 = i + 0.5f;
  message.f64 = i + 1.0 / 1024;
  message.text = "text " + std::to_string(i);
  for (long k = 0; k < size; k++) {
    message.truths.push_back((i + k) % 3 == 0);
    message.i8s.push_back(-((i + k) % 128));
    message.u8s.push_back((i + k) % 256);
    message.i16s.push_back(-(i + k));
    message.i32s.push_back(-100000 * k);
    message.u32s.push_back(4000000000u + k);
    message.u64s.push_back(18000000000000000000ULL + k);
    message.f32s.push_back(k + 0.25f);
    message.texts.push_back(std::string(k, 't'));
  }
  for (int k = 0; k < 3; k++) message.u16s[k] = 65000 + k;
  for (int k = 0; k < 2; k++) message.i64s[k] = -9000000000000000000LL - k;
  for (int k = 0; k < 4; k++) message.f64s[k] = k / 8.0;
  message.pair[0] = "left";
}

static void fill(sensor_msgs::Image& message, int i, long size) {
  fill(message.header, i);
  message.height = 1;
  message.width = message.step = size;
  message.encoding = "mono8";
  message.data.resize(size);
  for (long k = 0; k < size; k++) message.data[k] = (i + k) % 251;
}

static void fill(sensor_msgs::PointCloud2& message, int i, long size) {
  const char* names[] = {"x", "y", "z", "intensity"};
  fill(message.header, i);
  message.height = 1;
  message.width = size;
  for (int k = 0; k < 4; k++) {
    sensor_msgs::PointField field;
    field.name = names[k];
    field.offset = 4 * k;
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    message.fields.push_back(field);
  }
  message.point_step = 16;
  message.row_step = 16 * size;
  message.is_dense = true;
  message.data.resize(16 * size);
  for (long k = 0; k < 16 * size; k++) message.data[k] = (7 * i + k) % 256;
}

// header.seq belongs to the publisher: it is not compared here.
template <class M> static auto take_seq(M& expected, const M& got, int) -> decltype(void(got.header)) {
  expected.header.seq = got.header.seq;
}
template <class M> static void take_seq(M&, const M&, long) {}

template <class M> static std::string bytes(const M& message) {
  uint32_t size = ros::serialization::serializationLength(message);
  std::string buffer(size, '\0');
  ros::serialization::OStream stream(reinterpret_cast<uint8_t*>(&buffer[0]), size);
  ros::serialization::serialize(stream, message);
  return buffer;
}

// ---- topics

struct Topic {
  ros::Publisher publisher;
  ros::Subscriber subscriber;
  std::function<void(int, long)> publish;
};

static ros::NodeHandle* node;
static std::map<std::string, Topic> published, subscribed;

template <class M> static void advertise(const std::string& name, bool latch) {
  Topic& topic = published[name];
  topic.publisher = node->advertise<M>(name, 200, latch);
  topic.publish = [&topic](int i, long size) {
    M message;
    fill(message, i, size);
    topic.publisher.publish(message);
  };
  tell("advertised", name);
}

template <class M> static void subscribe(const std::string& name, long size, const std::string& hint) {
  auto count = std::make_shared<int>(0);
  boost::function<void(const boost::shared_ptr<M const>&)> callback =
      [name, size, count](const boost::shared_ptr<M const>& got) {
        M expected;
        int i = (*count)++;
        fill(expected, i, size);
        take_seq(expected, *got, 0);
        tell("got", name, i, bytes(expected) == bytes(*got) ? "ok" : "differs");
      };
  ros::TransportHints hints = hint == "udp" ? ros::TransportHints().udp() : ros::TransportHints().tcpNoDelay();
  subscribed[name].subscriber = node->subscribe<M>(name, 200, callback, ros::VoidConstPtr(), hints);
  tell("subscribed", name);
}

template <class M> static void with_type(bool advertising, const std::string& name, long number, const std::string& hint) {
  if (advertising) advertise<M>(name, number != 0);
  else subscribe<M>(name, number, hint);
}

static void topic_command(bool advertising, std::istringstream& line) {
  std::string type, name, hint;
  long number = 0;
  line >> type >> name >> number >> hint;
  static const std::map<std::string, void (*)(bool, const std::string&, long, const std::string&)> types = {
      {"std_msgs/String", with_type<std_msgs::String>},
      {"mros_comm_measure/Coordinate", with_type<mros_comm_measure::Coordinate>},
      {"peer_msgs/UserTypeTest", with_type<peer_msgs::UserTypeTest>},
      {"peer_msgs/Crowd", with_type<peer_msgs::Crowd>},
      {"peer_msgs/Stamps", with_type<peer_msgs::Stamps>},
      {"peer_msgs/Primitives", with_type<peer_msgs::Primitives>},
      {"sensor_msgs/Image", with_type<sensor_msgs::Image>},
      {"sensor_msgs/PointCloud2", with_type<sensor_msgs::PointCloud2>},
  };
  auto found = types.find(type);
  if (found == types.end()) tell("unknown type", type);
  else found->second(advertising, name, number, hint);
}

// ---- services

static std::map<std::string, ros::ServiceServer> services;
static std::map<std::string, ros::ServiceClient> clients;  // the persistent ones

static void scale(const peer_msgs::Scale::Request& request, peer_msgs::Scale::Response& response) {
  response.points = request.points;
  for (auto& point : response.points) {
    point.x *= request.factor;
    point.y *= request.factor;
    point.z *= request.factor;
  }
  response.text = "scaled " + std::to_string(request.points.size());
}

static bool on_scale(peer_msgs::Scale::Request& request, peer_msgs::Scale::Response& response) {
  if (request.factor == 0) return false;
  scale(request, response);
  return true;
}

static void call(std::istringstream& line) {
  std::string name;
  int count = 0, persistent = 0;
  double factor = 0;
  line >> name >> count >> factor >> persistent;
  peer_msgs::Scale scaled;
  peer_msgs::Scale::Response expected;
  for (int k = 0; k < count; k++) {
    scaled.request.points.emplace_back();
    fill(scaled.request.points.back(), k);
  }
  scaled.request.factor = factor;
  scale(scaled.request, expected);
  if (!clients.count(name) || !persistent) clients[name] = node->serviceClient<peer_msgs::Scale>(name, persistent != 0);
  if (!clients[name].call(scaled)) tell("called", name, "failed");
  else tell("called", name, bytes(expected) == bytes(scaled.response) ? "ok" : "differs");
}

// ---- parameters

static void set_parameter(std::istringstream& line) {
  std::string name, kind, value;
  line >> name >> kind;
  std::getline(line >> std::ws, value);
  if (kind == "int") node->setParam(name, std::stoi(value));
  else if (kind == "double") node->setParam(name, std::stod(value));
  else if (kind == "bool") node->setParam(name, value == "1");
  else if (kind == "string") node->setParam(name, value);
  else if (kind == "doubles") node->setParam(name, std::vector<double>{1.5, -2.25, 1e300});
  else if (kind == "ints") node->setParam(name, std::map<std::string, int>{{"one", 1}, {"two", 2}});
  tell("set", name);
}

static void get_parameter(std::istringstream& line) {
  std::string name, kind;
  line >> name >> kind;
  std::ostringstream text;
  text.precision(17);
  int number;
  double real;
  bool truth;
  std::string string;
  std::vector<double> reals;
  std::map<std::string, int> numbers;
  if (kind == "int" && node->getParam(name, number)) text << number;
  else if (kind == "double" && node->getParam(name, real)) text << real;
  else if (kind == "bool" && node->getParam(name, truth)) text << truth;
  else if (kind == "string" && node->getParam(name, string)) text << string;
  else if (kind == "doubles" && node->getParam(name, reals)) for (double each : reals) text << each << ";";
  else if (kind == "ints" && node->getParam(name, numbers)) for (auto& each : numbers) text << each.first << "=" << each.second << ";";
  else return tell("missing", name);
  tell("value", name, kind, text.str());
}

int main(int argc, char** argv) {
  ros::init(argc, argv, "roscpp_peer", ros::init_options::NoSigintHandler);
  ros::NodeHandle handle;
  node = &handle;
  ros::AsyncSpinner spinner(1);
  spinner.start();
  tell("ready", ros::this_node::getName());
  for (std::string text; std::getline(std::cin, text);) {
    std::istringstream line(text);
    std::string command, name;
    line >> command;
    if (command == "advertise") topic_command(true, line);
    else if (command == "subscribe") topic_command(false, line);
    else if (command == "set") set_parameter(line);
    else if (command == "get") get_parameter(line);
    else if (command == "call") call(line);
    else if (command == "quit") break;
    else if (line >> name) {
      if (command == "publish") {
        int i = 0;
        long size = 0;
        line >> i >> size;
        published[name].publish(i, size);
        tell("published", name, i);
      } else if (command == "subscribers") tell("subscribers", name, published[name].publisher.getNumSubscribers());
      else if (command == "publishers") tell("publishers", name, subscribed[name].subscriber.getNumPublishers());
      else if (command == "unadvertise") { published.erase(name); tell("unadvertised", name); }
      else if (command == "unsubscribe") { subscribed.erase(name); tell("unsubscribed", name); }
      else if (command == "serve") { services[name] = handle.advertiseService(name, on_scale); tell("serving", name); }
    }
  }
  ros::shutdown();
  return 0;
}
