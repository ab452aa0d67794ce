#include "formats/mesh/sandbox/assembly_stream.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <span>
#include <type_traits>

#include "formats/file/descriptor.h"

namespace forcelayer::mesh {
namespace {

constexpr std::uint64_t kMagic = 0x316d6c6173736105;  // both ends are the same program

class Sender {
 public:
  explicit Sender(int descriptor) : descriptor_(descriptor) {}
  ~Sender() { flush(); }

  void bytes(std::span<const std::byte> piece) {
    if (pending_.size() + piece.size() > kBuffer) flush();
    if (piece.size() > kBuffer) {
      write(piece);
    } else {
      pending_.insert(pending_.end(), piece.begin(), piece.end());
    }
  }
  template <class T>
  void value(const T& item) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes(std::as_bytes(std::span(&item, 1)));
  }
  template <class List>
  void list(const List& items) {
    value(std::uint64_t{items.size()});
    bytes(std::as_bytes(std::span(items)));
  }
  bool flush() {
    write(pending_);
    pending_.clear();
    return good_;
  }

 private:
  static constexpr std::size_t kBuffer = std::size_t{1} << 16;

  void write(std::span<const std::byte> piece) {
    good_ = good_ && write_all(descriptor_, piece) == 0;
  }

  int descriptor_;
  bool good_ = true;
  std::vector<std::byte> pending_;
};

class Receiver {
 public:
  Receiver(int descriptor, std::uint64_t max_bytes, std::chrono::steady_clock::time_point deadline)
      : descriptor_(descriptor), left_bytes_(max_bytes), deadline_(deadline) {}

  // These throw BrokenStream.
  void bytes(std::span<std::byte> piece) {
    if (piece.size() > left_bytes_) throw BrokenStream::kTooLong;
    left_bytes_ -= piece.size();
    while (!piece.empty()) {
      wait();
      const auto got = ::read(descriptor_, piece.data(), piece.size());
      if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (got <= 0) throw BrokenStream::kEnded;
      piece = piece.subspan(static_cast<std::size_t>(got));
    }
  }
  template <class T>
  T value() {
    T item{};
    bytes(std::as_writable_bytes(std::span(&item, 1)));
    return item;
  }
  template <class List>
  List list() {
    using Item = typename List::value_type;
    constexpr std::size_t kPiece = (std::size_t{16} << 20) / sizeof(Item);
    const auto count = value<std::uint64_t>();
    if (count > left_bytes_ / sizeof(Item)) throw BrokenStream::kTooLong;
    List items;
    while (items.size() < count) {
      const std::size_t have = items.size();
      // At most twice what has arrived: an announcement alone takes no memory.
      items.resize(std::min<std::size_t>(count, have + std::max(have, kPiece)));
      bytes(std::as_writable_bytes(std::span(items).subspan(have)));
    }
    return items;
  }
  std::string text() { return list<std::string>(); }
  bool flag() {
    const auto number = value<std::uint64_t>();
    if (number > 1) throw BrokenStream::kNonsense;
    return number == 1;
  }

 private:
  void wait() const {
    using std::chrono::milliseconds;
    while (true) {
      const auto left =
          std::chrono::duration_cast<milliseconds>(deadline_ - std::chrono::steady_clock::now());
      if (left.count() <= 0) throw BrokenStream::kTooLate;
      constexpr milliseconds kLongest{60000};
      pollfd waiting{descriptor_, POLLIN, 0};
      if (::poll(&waiting, 1, static_cast<int>(std::min(left, kLongest).count()) + 1) > 0) return;
    }
  }

  int descriptor_;
  std::uint64_t left_bytes_;
  std::chrono::steady_clock::time_point deadline_;
};

void send_error(Sender& sender, const Error& error) {
  sender.value(static_cast<std::uint64_t>(error.code));
  for (const std::string* text : {&error.file, &error.where, &error.what, &error.mend}) {
    sender.list(*text);
  }
}

// Takes only the codes that a mesh reader may send.
Error receive_error(Receiver& receiver) {
  Error error;
  const auto code = receiver.value<std::uint64_t>();
  const bool known = (code > 100 && code <= static_cast<int>(ErrorCode::kOutOfMemory)) ||
                     (code >= static_cast<int>(ErrorCode::kMeshUnreadable) &&
                      code <= static_cast<int>(ErrorCode::kBakeTooLarge));
  if (!known) throw BrokenStream::kNonsense;
  error.code = static_cast<ErrorCode>(code);
  for (std::string* text : {&error.file, &error.where, &error.what, &error.mend}) {
    *text = receiver.text();
  }
  return error;
}

void send_content(Sender& sender, const Assembly& assembly) {
  sender.value(std::uint64_t{assembly.meshes.size()});
  for (const Mesh& mesh : assembly.meshes) {
    sender.list(mesh.vertices);
    sender.list(mesh.triangles);
    sender.value(std::uint64_t{mesh.single_precision});
  }
  sender.value(std::uint64_t{assembly.instances.size()});
  for (const MeshInstance& instance : assembly.instances) {
    sender.value(instance.mesh);
    sender.list(instance.name);
    sender.value(instance.assembly_from_mesh);
    sender.value(instance.deviation_units);
  }
  sender.value(std::uint64_t{assembly.meters_per_unit.has_value()});
  sender.value(assembly.meters_per_unit.value_or(0));
  sender.value(std::uint64_t{assembly.up.has_value()});
  sender.value(std::uint64_t{assembly.up == Up::kY});
  sender.value(std::uint64_t{assembly.warnings.size()});
  for (const std::string& warning : assembly.warnings) sender.list(warning);
  sender.value(std::uint64_t{assembly.missing_faces.size()});
  for (const MissingFace& face : assembly.missing_faces) {
    sender.list(face.node);
    sender.value(face.center);
    sender.value(face.size);
  }
  sender.value(std::uint64_t{assembly.nodes.size()});
  for (const AssemblyNode& node : assembly.nodes) {
    sender.list(node.label);
    sender.list(node.path);
    sender.value(std::uint64_t{node.depth});
    sender.value(node.first_instance);
    sender.value(node.instance_count);
  }
  sender.value(std::uint64_t{assembly.left_out.size()});
  for (const std::string& name : assembly.left_out) sender.list(name);
}

void expect(bool sound) {
  if (!sound) throw BrokenStream::kNonsense;
}

template <class Numbers>
bool all_finite(const Numbers& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

Mesh receive_mesh(Receiver& receiver) {
  Mesh mesh;
  mesh.vertices = receiver.list<std::vector<Vec3d>>();
  mesh.triangles = receiver.list<std::vector<Triangle>>();
  mesh.single_precision = receiver.flag();
  for (const Vec3d& vertex : mesh.vertices) expect(all_finite(vertex));
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) expect(corner < mesh.vertices.size());
  }
  return mesh;
}

// Depths descend by any number and ascend by one, from 0.
AssemblyNode receive_node(Receiver& receiver, const Assembly& assembly) {
  AssemblyNode node;
  node.label = receiver.text();
  node.path = receiver.text();
  node.depth = receiver.value<std::uint64_t>();
  node.first_instance = receiver.value<std::uint32_t>();
  node.instance_count = receiver.value<std::uint32_t>();
  expect(node.depth <= (assembly.nodes.empty() ? 0 : assembly.nodes.back().depth + 1));
  expect(node.first_instance <= assembly.instances.size());
  expect(node.instance_count <= assembly.instances.size() - node.first_instance);
  return node;
}

Assembly receive_content(Receiver& receiver) {
  Assembly assembly;
  for (auto n = receiver.value<std::uint64_t>(); n > 0; --n) {
    assembly.meshes.push_back(receive_mesh(receiver));
  }
  for (auto n = receiver.value<std::uint64_t>(); n > 0; --n) {
    MeshInstance& instance = assembly.instances.emplace_back();
    instance.mesh = receiver.value<std::uint32_t>();
    expect(instance.mesh < assembly.meshes.size());
    instance.name = receiver.text();
    instance.assembly_from_mesh = receiver.value<Affine>();
    expect(all_finite(instance.assembly_from_mesh.linear));
    expect(all_finite(instance.assembly_from_mesh.translation));
    instance.deviation_units = receiver.value<double>();
    expect(std::isfinite(instance.deviation_units) && instance.deviation_units >= 0);
  }
  const bool has_unit = receiver.flag();
  const auto unit = receiver.value<double>();
  if (has_unit) {
    expect(std::isfinite(unit) && unit > 0);
    assembly.meters_per_unit = unit;
  }
  const bool has_up = receiver.flag(), is_y_up = receiver.flag();
  if (has_up) assembly.up = is_y_up ? Up::kY : Up::kZ;
  for (auto n = receiver.value<std::uint64_t>(); n > 0; --n) {
    assembly.warnings.push_back(receiver.text());
  }
  for (auto n = receiver.value<std::uint64_t>(); n > 0; --n) {
    MissingFace& face = assembly.missing_faces.emplace_back();
    face.node = receiver.text();
    face.center = receiver.value<Vec3d>();
    face.size = receiver.value<double>();
    expect(all_finite(face.center) && std::isfinite(face.size) && face.size >= 0);
  }
  for (auto n = receiver.value<std::uint64_t>(); n > 0; --n) {
    assembly.nodes.push_back(receive_node(receiver, assembly));
  }
  for (auto n = receiver.value<std::uint64_t>(); n > 0; --n) {
    assembly.left_out.push_back(receiver.text());
  }
  measure_instances(assembly);
  return assembly;
}

}  // namespace

bool send_assembly(int descriptor, const Result<Assembly>& assembly) {
  Sender sender(descriptor);
  sender.value(kMagic);
  sender.value(std::uint64_t{assembly.ok()});
  if (assembly) {
    send_content(sender, *assembly);
  } else {
    send_error(sender, assembly.error());
  }
  sender.value(kMagic);
  return sender.flush();
}

ReceivedAssembly receive_assembly(int descriptor, std::uint64_t max_bytes,
                                  std::chrono::steady_clock::time_point deadline) {
  Receiver receiver(descriptor, max_bytes, deadline);
  ReceivedAssembly received;
  try {
    expect(receiver.value<std::uint64_t>() == kMagic);
    if (receiver.flag()) {
      Assembly assembly = receive_content(receiver);
      expect(receiver.value<std::uint64_t>() == kMagic);
      received.assembly = std::move(assembly);
    } else {
      Error error = receive_error(receiver);
      expect(receiver.value<std::uint64_t>() == kMagic);
      received.assembly = std::move(error);
    }
  } catch (const BrokenStream& how) {
    received.broken = how;
  }
  return received;
}

}  // namespace forcelayer::mesh
