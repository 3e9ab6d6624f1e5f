"""MCAP files and bags, as recorders of ROS 2 and ROS 1 write them."""

import bz2
import struct
import zlib

LINE = "\n" + "=" * 80 + "\n"
VECTOR = LINE + "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z"
HEADER = (LINE + "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id" + LINE +
          "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n")
HEADER_OF_ROS1 = LINE + "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
WRENCH = "Wrench wrench" + LINE + "MSG: geometry_msgs/Wrench\nVector3  force\nVector3  torque" + VECTOR
POSE = ("Pose pose" + LINE + "MSG: geometry_msgs/Pose\nPoint position\nQuaternion orientation" + LINE +
        "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z" + LINE +
        "MSG: geometry_msgs/Quaternion\nfloat64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1")
IMAGE = "uint32 height\nuint32 width\nuint8[] data" + HEADER
WRENCH_OF_ROS1 = "Header header\n" + WRENCH + HEADER_OF_ROS1
TYPES = {
    "geometry_msgs/msg/WrenchStamped": "std_msgs/Header header\n" + WRENCH + HEADER,
    "geometry_msgs/msg/PoseStamped": "std_msgs/Header header\n" + POSE + HEADER,
    "sensor_msgs/msg/Image": "std_msgs/Header header\n" + IMAGE,
    "sensor_msgs/msg/JointState": "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
                                  "float64[] effort" + HEADER,
}
MAGIC = b"\x89MCAP0\r\n"


def text(value):
    return struct.pack("<I", len(value.encode())) + value.encode()


def record(kind, content):
    return struct.pack("<BQ", kind, len(content)) + content


class Cdr:
    """A message, whose fields are aligned."""

    def __init__(self, nanoseconds=None, frame="tool0"):
        self.fields = bytearray()
        if nanoseconds is not None:
            self.add("i", nanoseconds // 10**9).add("I", nanoseconds % 10**9).string(frame)

    def add(self, kind, *values):
        size = struct.calcsize(kind)
        self.fields += b"\0" * (-len(self.fields) % size) + struct.pack(f"<{len(values)}{kind}", *values)
        return self

    def string(self, value):
        self.add("I", len(value.encode()) + 1)
        self.fields += value.encode() + b"\0"
        return self

    def bytes(self):
        return b"\0\1\0\0" + bytes(self.fields)


def wrench(nanoseconds, x, y, frame="tool0"):
    return Cdr(nanoseconds, frame).add("d", x, y, 0.0, 0.0, 0.0, 0.0).bytes()


def pose(nanoseconds, x, y, frame="base_link"):
    return Cdr(nanoseconds, frame).add("d", x, y, 0.5, 0.0, 0.0, 0.0, 1.0).bytes()


def joint_state(nanoseconds, joints):
    """joints: {name: (position, effort)}, in the order of the message."""
    message = Cdr(nanoseconds, "").add("I", len(joints))
    for name in joints:
        message.string(name)
    for values in ([one[0] for one in joints.values()], [], [one[1] for one in joints.values()]):
        message.add("I", len(values))
        if values:
            message.add("d", *values)
    return message.bytes()


class Mcap:
    """A file of one chunk after the other, without a summary. topics: {topic: type}."""

    def __init__(self, path, topics):
        self.file = open(path, "wb")  # pylint: disable=consider-using-with
        self.file.write(MAGIC + record(1, text("ros2") + text("of a test")))
        self.numbers = {topic: number for number, topic in enumerate(topics, 1)}
        self.open = bytearray()
        for topic, number in self.numbers.items():
            kind = topics[topic]
            self.open += record(3, struct.pack("<H", number) + text(kind) + text("ros2msg") + text(TYPES[kind]))
            self.open += record(4, struct.pack("<HH", number, number) + text(topic) + text("cdr") + text(""))

    def add(self, topic, nanoseconds, message):
        self.open += record(5, struct.pack("<HIQQ", self.numbers[topic], 0, nanoseconds, nanoseconds) + message)
        if len(self.open) > 1 << 20:
            self.chunk()

    def chunk(self):
        self.file.write(record(6, struct.pack("<QQQI", 0, 0, len(self.open), zlib.crc32(self.open)) + text("") +
                               struct.pack("<Q", len(self.open)) + self.open))
        self.open = bytearray()

    def close(self):
        self.chunk()
        self.file.write(record(15, bytes(4)) + record(2, bytes(20)) + MAGIC)
        self.file.close()


def pairs(**values):
    return b"".join(text_of_bytes(name.encode() + b"=" + value) for name, value in values.items())


def text_of_bytes(value):
    return struct.pack("<I", len(value)) + value


def bag_record(operation, data, **header):
    return text_of_bytes(pairs(op=bytes([operation]), **header)) + text_of_bytes(data)


def wrench_of_ros1(nanoseconds, x, y):
    seconds, rest = divmod(nanoseconds, 10**9)
    return struct.pack("<III", 0, seconds, rest) + text("tool0") + struct.pack("<6d", x, y, 0, 0, 0, 0)


def write_bag(path, topic, samples):
    """A bag of wrenches in one chunk, packed by bz2. samples: (nanoseconds, x, y)."""
    number = struct.pack("<I", 0)
    connection = bag_record(7, pairs(topic=topic.encode(), type=b"geometry_msgs/WrenchStamped", md5sum=b"0",
                                     message_definition=WRENCH_OF_ROS1.encode()), conn=number, topic=topic.encode())
    records = connection
    for nanoseconds, x, y in samples:
        records += bag_record(2, wrench_of_ros1(nanoseconds, x, y), conn=number,
                              time=struct.pack("<II", *divmod(nanoseconds, 10**9)))
    chunk = bag_record(5, bz2.compress(records), compression=b"bz2", size=struct.pack("<I", len(records)))
    header = bag_record(3, b" " * 4000, index_pos=struct.pack("<Q", 4117 + len(chunk)),
                        conn_count=number, chunk_count=number)
    path.write_bytes(b"#ROSBAG V2.0\n" + header + chunk + connection)
    return path
