// Mesh files: the reader by the ending of the name, the checks, and the writer.
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "host/atomic_file.h"
#include "host/mesh_readers.h"
#include "host/validate_steps.h"

namespace gliss {
namespace {

using Reader = void (*)(std::string_view, Mesh&, Report&);

Reader reader_of(const std::string& path, Report& report) {
  const std::size_t dot = path.find_last_of("./");
  std::string ending = dot == std::string::npos ? "" : path.substr(dot);
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (ending == ".obj") return read_obj;
  if (ending == ".off") return read_off;
  if (ending == ".ply") return read_ply;
  report.fail("unsupported", {}, "the file must end in .obj, .off or .ply");
}

std::string read_file(const std::string& path, Report& report) {
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
  std::string text;
  std::size_t got = file ? 1 : 0;
  while (got > 0) {
    constexpr std::size_t kBlock = 1 << 20;
    const std::size_t size = text.size();
    if (text.capacity() < size + kBlock) text.reserve(2 * size + kBlock);
    text.resize(size + kBlock);
    got = std::fread(text.data() + size, 1, kBlock, file.get());
    text.resize(size + got);
  }
  if (!file || std::ferror(file.get())) {
    report.fail("unreadable", {}, "cannot be read: {}", std::strerror(errno));
  }
  return text;
}

}  // namespace

Mesh load_mesh(const std::string& path, const LoadOptions& options,
               std::vector<Finding>* findings) {
  Mesh mesh;
  mesh.source = path;
  mesh.unit = options.unit;
  Report report(mesh, findings);
  const Reader read = reader_of(path, report);
  const std::string text = read_file(path, report);
  if (text.starts_with("\x1f\x8b")) {
    report.fail("unsupported", {}, "is compressed by gzip; unpack it first");
  }
  read(text, mesh, report);
  validate(mesh, options, report);
  return mesh;
}

void save_obj(const Mesh& mesh, const std::string& path, const std::string& comment) {
  AtomicFile file(path);
  fmt::memory_buffer line;
  const fmt::appender out(line);
  const auto end_line = [&] {
    line.push_back('\n');
    file.write(line.data(), line.size());
    line.clear();
  };

  for (std::size_t begin = 0; begin < comment.size();) {
    const std::size_t end = std::min(comment.find_first_of("\r\n", begin), comment.size());
    fmt::format_to(out, "# {}", std::string_view(comment).substr(begin, end - begin));
    end_line();
    begin = end + 1;
  }
  fmt::format_to(out, "# unit: {:.17g} m", mesh.unit);
  end_line();
  for (const Vec3& p : mesh.positions) {
    fmt::format_to(out, "v {:.17g} {:.17g} {:.17g}", p.x(), p.y(), p.z());
    end_line();
  }
  for (const Vec3& n : mesh.normals) {
    fmt::format_to(out, "vn {:.17g} {:.17g} {:.17g}", n.x(), n.y(), n.z());
    end_line();
  }
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    line.push_back('f');
    for (std::uint32_t c = mesh.face_begin[face]; c < mesh.face_begin[face + 1]; ++c) {
      fmt::format_to(out, " {}", mesh.corner_vertex[c] + 1);
      if (!mesh.normals.empty()) fmt::format_to(out, "//{}", mesh.corner_normal[c] + 1);
    }
    end_line();
  }
  file.commit();
}

}  // namespace gliss
