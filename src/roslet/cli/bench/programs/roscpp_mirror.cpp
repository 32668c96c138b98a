// roscpp in the validity part of `roslet bench`: the role mirror of pinger.py. What it read it prints with the printers that
// gencpp generates, between a line "type N" and a line "end".
//   roscpp_mirror TYPE...
#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseWithCovarianceStamped.h>
#include <mros_comm_measure/Coordinate.h>
#include <ros/ros.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Byte.h>
#include <std_msgs/Char.h>
#include <std_msgs/Duration.h>
#include <std_msgs/Float32.h>
#include <std_msgs/Float32MultiArray.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>
#include <std_msgs/Int16.h>
#include <std_msgs/Int16MultiArray.h>
#include <std_msgs/Int32.h>
#include <std_msgs/Int32MultiArray.h>
#include <std_msgs/Int64.h>
#include <std_msgs/Int64MultiArray.h>
#include <std_msgs/Int8.h>
#include <std_msgs/Int8MultiArray.h>
#include <std_msgs/String.h>
#include <std_msgs/Time.h>
#include <std_msgs/UInt16.h>
#include <std_msgs/UInt16MultiArray.h>
#include <std_msgs/UInt32.h>
#include <std_msgs/UInt32MultiArray.h>
#include <std_msgs/UInt64.h>
#include <std_msgs/UInt64MultiArray.h>
#include <std_msgs/UInt8.h>
#include <std_msgs/UInt8MultiArray.h>
#include <unistd.h>

#include <iomanip>
#include <iostream>
#include <thread>

static std::vector<ros::Publisher> publishers;
static std::vector<ros::Subscriber> subscribers;

template <class M> static void show(const M& message) { std::cout << message; }
static void show(const std_msgs::Duration& message) {
  std::cout << "sec: " << message.data.sec << "\nnsec: " << message.data.nsec << "\n";
}

template <class M> static bool mirror(ros::NodeHandle& node, const std::string& type, int number) {
  if (type != ros::message_traits::datatype<M>()) return false;
  ros::Publisher publisher = node.advertise<M>("back_" + std::to_string(number), 10);
  boost::function<void(const boost::shared_ptr<M const>&)> heard =
      [publisher, number](const boost::shared_ptr<M const>& message) {
        std::cout << "type " << number << "\n";
        show(*message);
        std::cout << "end" << std::endl;
        publisher.publish(message);
      };
  publishers.push_back(publisher);
  subscribers.push_back(node.subscribe<M>("there_" + std::to_string(number), 10, heard));
  return true;
}

template <class... M> static bool any(ros::NodeHandle& node, const std::string& type, int number) {
  return (mirror<M>(node, type, number) || ...);
}

int main(int argc, char** argv) {
  using namespace std_msgs;
  ros::init(argc, argv, "bench_mirror", ros::init_options::NoSigintHandler);
  ros::NodeHandle node;
  std::thread([] {
    char octet;
    while (read(0, &octet, 1) > 0) {}
    ros::shutdown();
  }).detach();
  std::cout << std::setprecision(17);
  for (int k = 1; k < argc; k++) {
    bool known =
        any<Bool, Byte, Char, Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Float32, Float64, String, Time,
            Duration, Int8MultiArray, UInt8MultiArray, Int16MultiArray, UInt16MultiArray, Int32MultiArray,
            UInt32MultiArray, Int64MultiArray, UInt64MultiArray, Float32MultiArray, Float64MultiArray,
            geometry_msgs::PointStamped, geometry_msgs::PoseWithCovarianceStamped, mros_comm_measure::Coordinate,
            sensor_msgs::Image>(node, argv[k], k - 1);
    if (!known) std::cout << "lacks " << k - 1 << std::endl;
  }
  std::cout << "ready" << std::endl;
  ros::spin();
  publishers.clear();
  subscribers.clear();
}
