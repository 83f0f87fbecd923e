// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/messages.hpp"
#include "triskin/recording/ros_text.hpp"

namespace triskin::recording {
namespace {

constexpr std::string_view kRawFrame =
    "# Samples of modules of one controller with one sample number\n"
    "uint8 node               # address of the controller\n"
    "uint32 sample            # number of the sample in the controller\n"
    "uint64 device_time_us    # clock of the controller, of the first module\n"
    "uint64 link_time_us      # clock of the link when the first module came\n"
    "uint32[] module          # number in the design\n"
    "uint8[] row              # row in the table of the controller\n"
    "uint16[] valid           # bit t: taxel t holds a valid value\n"
    "uint8[] state            # state of the module, docs/protocol.md\n"
    "uint32[] link_delay_us   # after link_time_us\n"
    "int32[] device_delay_us  # after device_time_us\n"
    "uint16[] value           # counts, 12 a module\n"
    "uint64 sampled_ns        # when the first module was sampled, since 1970, by the clocks; 0: not known\n"
    "uint32 error_us          # of sampled_ns, at most; 4294967295: not bounded\n";

constexpr std::string_view kLayout =
    "# Where the taxels of a design are\n"
    "std_msgs/Header header\n"
    "string name\n"
    "uint64 design_id\n"
    "float32[] corner         # m, 9 a module: three corners\n"
    "float32[] position       # m, 36 a module: twelve taxels\n"
    "float32[] normal         # 3 a module, outward\n"
    "int32[] patch            # 1 a module, -1: none\n"
    "uint32[] module          # 1 a module: its number, ascending, with gaps where modules were "
    "removed\n" TRISKIN_ROS_HEADER;

constexpr std::string_view kReaders =
    "# Which controller reads each module: one message at the beginning, with its own, and one at each change\n"
    "std_msgs/Header header\n"
    "uint64 link_time_us      # clock of the link when the first sample by another controller came\n"
    "int32[] patch            # 1 a module: that the controller which reads it serves, -1: none\n"
    "uint8[] node             # 1 a module: address of that controller, 0: it hangs on another "
    "bus\n" TRISKIN_ROS_HEADER;

constexpr std::string_view kContacts =
    "# Regions of the skin under pressure, the strongest first\n"
    "std_msgs/Header header\n"
    "string force_unit               # of the forces: counts (not calibrated) or N\n"
    "triskin_msgs/Contact[] contacts\n" TRISKIN_ROS_RULE
    "MSG: triskin_msgs/Contact\n"
    "# A region of the skin under pressure: taxels within 12 mm of each other\n"
    "geometry_msgs/Point position    # m, on the skin, fitted to what its taxels read\n"
    "geometry_msgs/Vector3 normal    # outward unit vector\n"
    "float64 force                   # against the normal, in the unit that Contacts names; in counts: sum of change\n"
    "float64 area                    # m2 of skin that is pressed\n"
    "uint32[] module                 # of each taxel, the strongest first: number in the design\n"
    "uint8[] taxel                   # its number in the module, 0 to 11\n"
    "float32[] change                # counts against rest\n"
    "float32[] taxel_position        # m, 3 a taxel\n"
    "float32[] taxel_normal          # 3 a taxel, outward\n" TRISKIN_ROS_HEADER TRISKIN_ROS_RULE
    "MSG: geometry_msgs/Point\n"
    "float64 x\n"
    "float64 y\n"
    "float64 z\n" TRISKIN_ROS_RULE
    "MSG: geometry_msgs/Vector3\n"
    "float64 x\n"
    "float64 y\n"
    "float64 z\n";

// Our types use these types of other packages; fields and order are those of ROS 2.
constexpr std::string_view kPointCloud =
    "std_msgs/Header header\n"
    "uint32 height\n"
    "uint32 width\n"
    "sensor_msgs/PointField[] fields\n"
    "bool is_bigendian\n"
    "uint32 point_step\n"
    "uint32 row_step\n"
    "uint8[] data\n"
    "bool is_dense\n" TRISKIN_ROS_HEADER TRISKIN_ROS_RULE
    "MSG: sensor_msgs/PointField\n"
    "uint8 INT8=1\n"
    "uint8 UINT8=2\n"
    "uint8 INT16=3\n"
    "uint8 UINT16=4\n"
    "uint8 INT32=5\n"
    "uint8 UINT32=6\n"
    "uint8 FLOAT32=7\n"
    "uint8 FLOAT64=8\n"
    "string name\n"
    "uint32 offset\n"
    "uint8 datatype\n"
    "uint32 count\n";

constexpr std::string_view kTransforms = "geometry_msgs/TransformStamped[] transforms\n" TRISKIN_ROS_RULE
                                         "MSG: geometry_msgs/TransformStamped\n"
                                         "std_msgs/Header header\n"
                                         "string child_frame_id\n"
                                         "geometry_msgs/Transform transform\n" TRISKIN_ROS_HEADER TRISKIN_ROS_RULE
                                         "MSG: geometry_msgs/Transform\n"
                                         "geometry_msgs/Vector3 translation\n"
                                         "geometry_msgs/Quaternion rotation\n" TRISKIN_ROS_RULE
                                         "MSG: geometry_msgs/Vector3\n"
                                         "float64 x\n"
                                         "float64 y\n"
                                         "float64 z\n" TRISKIN_ROS_RULE
                                         "MSG: geometry_msgs/Quaternion\n"
                                         "float64 x\n"
                                         "float64 y\n"
                                         "float64 z\n"
                                         "float64 w\n";

}  // namespace

const MessageType kRawFrameType{"triskin_msgs/msg/RawFrame", kRawFrame};
const MessageType kLayoutType{"triskin_msgs/msg/SkinLayout", kLayout};
const MessageType kReadersType{"triskin_msgs/msg/Readers", kReaders};
const MessageType kContactsType{"triskin_msgs/msg/Contacts", kContacts};
const MessageType kPointCloudType{"sensor_msgs/msg/PointCloud2", kPointCloud};
const MessageType kTransformsType{"tf2_msgs/msg/TFMessage", kTransforms};

}  // namespace triskin::recording
