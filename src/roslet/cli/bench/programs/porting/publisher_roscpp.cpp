#include <mros_comm_measure/Coordinate.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "mros_node");
  ros::NodeHandle nh;
  ros::Publisher chatter = nh.advertise<mros_comm_measure::Coordinate>("ping", 1);
  mros_comm_measure::Coordinate msg;
  ros::Rate rate(20);
  while (ros::ok()) {
    msg.x += 0.1;
    msg.y += 10.03;
    msg.z += 3.003;
    msg.time = ros::Time::now();
    chatter.publish(msg);
    rate.sleep();
  }
}
