// roscpp in `roslet bench`: the roles ping and echo of pinger.py, with the same lines on standard output.
//   roscpp_node ping CASES COUNT WARM_UP      CASES as 1,1024,coordinate
//   roscpp_node echo
#include <mros_comm_measure/Coordinate.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/String.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <sstream>
#include <thread>

using Clock = std::chrono::steady_clock;
static std::atomic<bool> closed{false};

static void say(const std::string& line) {
  puts(line.c_str());
  fflush(stdout);
}

template <class P> static bool spin(P predicate, double seconds) {
  auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (!predicate() && !closed) {
    double left = std::chrono::duration<double>(end - Clock::now()).count();
    if (left <= 0) break;
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(std::min(left, 0.05)));
  }
  return predicate();
}

template <class M> struct Pinger {
  ros::NodeHandle node;
  ros::Publisher publisher;
  ros::Subscriber subscriber;
  M message;
  long seen = 0, left = 0;
  Clock::time_point begin;
  std::vector<double> taken;

  Pinger(const std::string& there, const std::string& back) {
    publisher = node.advertise<M>(there, 10);
    subscriber = node.subscribe<M>(back, 10, &Pinger::answered, this, ros::TransportHints().tcpNoDelay());
  }
  void send() {
    begin = Clock::now();
    publisher.publish(message);
  }
  void answered(const boost::shared_ptr<M const>&) {
    auto now = Clock::now();
    seen++;
    if (!left) return;
    taken.push_back(std::chrono::duration<double, std::micro>(now - begin).count());
    if (--left) send();
  }
  void measure(const std::string& name, long count, long warm_up) {
    auto end = Clock::now() + std::chrono::seconds(20);
    seen = left = 0;
    while (!seen && Clock::now() < end && !closed) {
      publisher.publish(message);
      spin([&] { return seen > 0; }, 0.2);
    }
    for (long before = -1; before != seen;) {
      before = seen;
      spin([&] { return seen > before; }, 0.15);
    }
    if (!seen) return say("{\"case\": \"" + name + "\", \"failed\": \"nobody answers\"}");
    int lost = 0;
    taken.clear();
    left = count + warm_up;
    send();
    while (left && lost <= 3 && !closed) {
      size_t before = taken.size();
      spin([&] { return !left; }, 2.0);
      if (left && taken.size() == before) {
        lost++;
        send();
      }
    }
    left = 0;
    std::ostringstream line;
    line << "{\"case\": \"" << name << "\", \"lost\": " << lost << ", \"us\": [";
    for (size_t k = warm_up; k < taken.size(); k++) line << (k > size_t(warm_up) ? ", " : "") << taken[k];
    say(line.str() + "]}");
  }
};

static int exponent(long size) {
  int power = 0;
  while ((1L << power) < size) power++;
  return power;
}

static void ping(const std::string& cases, long count, long warm_up) {
  Pinger<std_msgs::String> texts("ping", "pong");
  Pinger<mros_comm_measure::Coordinate> points("ping_coordinate", "pong_coordinate");
  points.message.x = 1.5;
  points.message.y = -2.5;
  points.message.z = 3.25;
  std::istringstream names(cases);
  for (std::string name; std::getline(names, name, ',');) {
    if (name == "coordinate") points.measure(name, count, warm_up);
    else {
      texts.message.data = std::string(1, char('a' + exponent(std::stol(name))));
      texts.measure(name, count, warm_up);
    }
  }
  say("{\"done\": true}");
  while (!closed) usleep(50000);
}

static void echo() {
  ros::NodeHandle node;
  std::vector<std_msgs::String> answers(16);
  for (int power = 0; power < 16; power++) answers[power].data.assign(1L << power, 'x');
  ros::Publisher pong = node.advertise<std_msgs::String>("pong", 10);
  ros::Publisher back = node.advertise<mros_comm_measure::Coordinate>("pong_coordinate", 10);
  auto nodelay = ros::TransportHints().tcpNoDelay();
  boost::function<void(const std_msgs::String::ConstPtr&)> on_text = [&](const std_msgs::String::ConstPtr& message) {
    pong.publish(answers[message->data[0] - 'a']);
  };
  boost::function<void(const mros_comm_measure::Coordinate::ConstPtr&)> on_point =
      [&](const mros_comm_measure::Coordinate::ConstPtr& message) { back.publish(message); };
  auto texts = node.subscribe<std_msgs::String>("ping", 10, on_text, ros::VoidConstPtr(), nodelay);
  auto points =
      node.subscribe<mros_comm_measure::Coordinate>("ping_coordinate", 10, on_point, ros::VoidConstPtr(), nodelay);
  say("{\"ready\": true}");
  while (!closed) spin([] { return false; }, 0.25);
}

int main(int argc, char** argv) {
  ros::init(argc, argv, "bench_" + std::to_string(getpid()), ros::init_options::NoSigintHandler);
  ros::NodeHandle keeps_the_node;
  std::thread([] {
    char octet;
    while (read(0, &octet, 1) > 0) {}
    closed = true;
    sleep(2);
    _exit(0);
  }).detach();
  if (argc > 4 && std::string(argv[1]) == "ping") ping(argv[2], atol(argv[3]), atol(argv[4]));
  else echo();
  ros::shutdown();
  _exit(0);
}
