// mros_comm_measure/msg/Coordinate for rclpy on Fast DDS, by hand: its wheels have the headers of the type support that its
// generator would write code against, and not the generator. A module of CPython: the five capsules that a message class of
// rclpy has, and `use(Coordinate, Time)`, the classes of what is received.

#include <Python.h>

#include <cstring>

#include "rosidl_runtime_c/message_type_support_struct.h"
#include "rosidl_runtime_c/type_description/type_description__struct.h"
#include "rosidl_runtime_c/type_description/type_source__struct.h"
#include "rosidl_typesupport_fastrtps_cpp/message_type_support.h"

namespace
{
struct Coordinate
{
  float x, y, z;
  int32_t sec;
  uint32_t nanosec;
};

PyObject * coordinate_class = nullptr;
PyObject * time_class = nullptr;

// -- CDR

bool write(const void * from, eprosima::fastcdr::Cdr & cdr)
{
  const auto & message = *static_cast<const Coordinate *>(from);
  cdr << message.x << message.y << message.z << message.sec << message.nanosec;
  return true;
}

bool read(eprosima::fastcdr::Cdr & cdr, void * to)
{
  auto & message = *static_cast<Coordinate *>(to);
  cdr >> message.x >> message.y >> message.z >> message.sec >> message.nanosec;
  return true;
}

uint32_t size_of(const void *) {return 20;}

size_t largest(char & bounds)
{
  bounds = ROSIDL_TYPESUPPORT_FASTRTPS_PLAIN_TYPE;
  return 20;
}

message_type_support_callbacks_t callbacks = {
  "mros_comm_measure::msg", "Coordinate", write, read, size_of, largest, nullptr};

// -- what rcl asks for

const char * const IDENTIFIER = "rosidl_typesupport_fastrtps_c";

const rosidl_message_type_support_t * handle_of(const rosidl_message_type_support_t * handle, const char * identifier)
{
  return std::strcmp(identifier, IDENTIFIER) == 0 ? handle : nullptr;
}

rosidl_type_hash_t hash = {1, {
  0xb7, 0x4a, 0xed, 0x59, 0xe0, 0x0c, 0x3e, 0x6b, 0xbd, 0xbc, 0x22, 0x6d, 0xf7, 0x25, 0x20, 0x4c,
  0xa7, 0xf1, 0x4a, 0x50, 0x26, 0xc3, 0x05, 0x4f, 0x6d, 0xd2, 0x2f, 0xb1, 0xda, 0x47, 0x81, 0x01}};

const rosidl_type_hash_t * hash_of(const rosidl_message_type_support_t *) {return &hash;}

// Nobody asks for the description here: it has a name and no fields.
char name[] = "mros_comm_measure/msg/Coordinate";
rosidl_runtime_c__type_description__TypeDescription description = {
  {{name, sizeof name - 1, sizeof name}, {nullptr, 0, 0}}, {nullptr, 0, 0}};
rosidl_runtime_c__type_description__TypeSource__Sequence sources = {nullptr, 0, 0};

const rosidl_runtime_c__type_description__TypeDescription * description_of(const rosidl_message_type_support_t *)
{
  return &description;
}

const rosidl_runtime_c__type_description__TypeSource__Sequence * sources_of(const rosidl_message_type_support_t *)
{
  return &sources;
}

rosidl_message_type_support_t support = {IDENTIFIER, &callbacks, handle_of, hash_of, description_of, sources_of};

// -- Python

bool number(PyObject * from, const char * attribute, double & to)
{
  PyObject * found = PyObject_GetAttrString(from, attribute);
  if (!found) {
    return false;
  }
  to = PyFloat_AsDouble(found);
  Py_DECREF(found);
  return !PyErr_Occurred();
}

bool from_python(PyObject * from, void * to)
{
  auto & message = *static_cast<Coordinate *>(to);
  double x, y, z, sec, nanosec;
  PyObject * time = PyObject_GetAttrString(from, "time");
  bool right = time && number(from, "x", x) && number(from, "y", y) && number(from, "z", z) &&
    number(time, "sec", sec) && number(time, "nanosec", nanosec);
  Py_XDECREF(time);
  if (right) {
    message = {float(x), float(y), float(z), int32_t(sec), uint32_t(nanosec)};
  }
  return right;
}

PyObject * to_python(void * from)
{
  const auto & message = *static_cast<Coordinate *>(from);
  PyObject * none = PyTuple_New(0);
  PyObject * stamp = Py_BuildValue("{s:i,s:I}", "sec", message.sec, "nanosec", message.nanosec);
  PyObject * time = PyObject_Call(time_class, none, stamp);
  PyObject * fields = !time ? nullptr : Py_BuildValue(
    "{s:f,s:f,s:f,s:N}", "x", message.x, "y", message.y, "z", message.z, "time", time);
  PyObject * made = fields ? PyObject_Call(coordinate_class, none, fields) : nullptr;
  Py_DECREF(none);
  Py_XDECREF(stamp);
  Py_XDECREF(fields);
  return made;
}

void * create() {return new Coordinate();}
void destroy(void * message) {delete static_cast<Coordinate *>(message);}

PyObject * use(PyObject *, PyObject * arguments)
{
  if (!PyArg_ParseTuple(arguments, "OO", &coordinate_class, &time_class)) {
    return nullptr;
  }
  Py_INCREF(coordinate_class);
  Py_INCREF(time_class);
  Py_RETURN_NONE;
}

PyMethodDef methods[] = {{"use", use, METH_VARARGS, nullptr}, {nullptr, nullptr, 0, nullptr}};
PyModuleDef module = {
  PyModuleDef_HEAD_INIT, "rclpy_coordinate", nullptr, -1, methods, nullptr, nullptr, nullptr, nullptr};
}  // namespace

PyMODINIT_FUNC PyInit_rclpy_coordinate()
{
  PyObject * made = PyModule_Create(&module);
  const struct {const char * name; void * what;} capsules[] = {
    {"TYPE_SUPPORT", &support},
    {"CREATE_ROS_MESSAGE", reinterpret_cast<void *>(create)},
    {"CONVERT_FROM_PY", reinterpret_cast<void *>(from_python)},
    {"CONVERT_TO_PY", reinterpret_cast<void *>(to_python)},
    {"DESTROY_ROS_MESSAGE", reinterpret_cast<void *>(destroy)},
  };
  for (const auto & one : capsules) {
    PyModule_AddObject(made, one.name, PyCapsule_New(one.what, nullptr, nullptr));
  }
  return made;
}
