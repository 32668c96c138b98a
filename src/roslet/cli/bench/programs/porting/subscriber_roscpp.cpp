#include <mros_comm_measure/Coordinate.h>
#include <ros/ros.h>

void callback(const mros_comm_measure::Coordinate::ConstPtr& msg) {
  ROS_INFO("I heard [x:%d, y:%d, z:%d]", (int)(msg->x * 1000), (int)(msg->y * 1000), (int)(msg->z * 1000));
}

int main(int argc, char** argv) {
  ros::init(argc, argv, "mros_sub_node");
  ros::NodeHandle nh;
  ros::Subscriber sub = nh.subscribe("ping", 1, callback);
  ros::spin();
}
