// Inputs that want to hang the reader, to lead it elsewhere, or to fill the memory: each is refused
// by a line that names it, or read no further than it may be.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <filesystem>
#include <fstream>
#include <system_error>

#include "gliss/files/atomic_file.h"
#include "gliss/files/cache_file.h"
#include "gliss/files/mesh_file.h"
#include "gliss/files/open_file.h"
#include "gliss/generate/generate.h"
#include "gliss/scene/scene.h"
#include "gliss/tables/file_seal.h"
#include "gliss/tables/hdf5_handle.h"
#include "gliss/tables/hdf5_reader.h"
#include "gliss/tables/hdf5_types.h"
#include "gliss/tables/point_table.h"
#include "gliss/tables/result_table.h"
#include "tests/support/poll_gap.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/surfaces.h"

namespace gliss {
namespace {

using hdf5::Handle, test::message_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Stop {};  // as Ctrl-C is answered

class HostileFiles : public ::testing::Test {
 protected:
  // A name that says its kind, for each thing that is no file.
  std::vector<std::pair<std::string, std::string>> no_files(const std::string& ending) const {
    const std::string pipe = folder_ / ("pipe" + ending), device = folder_ / ("device" + ending),
                      socket = folder_ / ("socket" + ending);
    EXPECT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    std::filesystem::create_symlink("/dev/zero", device);
    sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
    if (socket.size() >= sizeof address.sun_path) return {{pipe, "a pipe"}, {device, "a device"}};
    socket.copy(address.sun_path, socket.size());
    const int listener = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    close(listener);
    return {{pipe, "a pipe"}, {device, "a device"}, {socket, "a socket"}};
  }

  template <class Error, class Read>
  void expect_only_files(const std::string& ending, const Read& read) const {
    for (const auto& [path, kind] : no_files(ending)) {
      EXPECT_THAT(message_of<Error>([&, &path = path] { read(path); }),
                  AllOf(HasSubstr(path), HasSubstr("it is " + kind),
                        HasSubstr("only regular files are read; write what comes out of it to a")));
    }
    std::filesystem::create_directory(folder_ / ("folder" + ending));
    EXPECT_THAT(message_of<std::runtime_error>([&] { read(folder_ / ("folder" + ending)); }),
                AllOf(HasSubstr("folder" + ending), HasSubstr("Is a directory")));
  }

  const test::ScratchFolder folder_;
};

TEST_F(HostileFiles, that_are_no_files_are_refused_by_each_reader_of_meshes) {
  for (const char* ending : {".obj", ".off", ".ply"}) {
    expect_only_files<MeshError>(ending, [](const std::string& path) { load_mesh(path); });
  }
}

TEST_F(HostileFiles, that_are_no_files_are_refused_as_tables) {
  for (const char* ending : {".csv", ".npy"})
    expect_only_files<NoFileError>(ending, [](const std::string& path) { read_points(path, 1); });
  expect_only_files<RecordingError>(".h5", [](const std::string& path) { read_points(path, 1); });
}

TEST_F(HostileFiles, that_are_no_files_are_refused_as_caches) {
  expect_only_files<NoFileError>(".gliss", [](const std::string& path) {
    EXPECT_FALSE(is_cache_file(path));
    load_cache(path);
  });
}

TEST_F(HostileFiles, that_are_no_files_are_refused_as_scenes) {
  expect_only_files<SceneError>(".toml", [](const std::string& path) { read_scene(path); });
}

TEST_F(HostileFiles, that_are_no_files_are_refused_as_the_path_of_a_scene) {
  expect_only_files<SceneError>(".csv", [&](const std::string& path) {
    const auto text = "[sim]\npath = '" + path + "'\n";
    try {
      read_scene(folder_.write("scene.toml", text));
    } catch (const SceneError& error) {
      EXPECT_THAT(error.what(), HasSubstr("scene.toml:2: sim.path: "));
      throw;
    }
  });
}

TEST_F(HostileFiles, standard_input_is_told_how_to_be_read) {
  EXPECT_THAT(message_of<MeshError>([] { load_mesh("-"); }),
              HasSubstr("standard input is not read; write what comes out of it to a file"));
}

// A hole takes no place and has no lines. A small one is read, though not to its end.
TEST_F(HostileFiles, without_lines_are_no_meshes) {
  for (const char* name : {"hole.obj", "hole.off", "hole.ply"}) {
    folder_.write(name, "");
    std::filesystem::resize_file(folder_ / name, 48 << 20);
    EXPECT_THAT(message_of<MeshError>([&] { load_mesh(folder_ / name); }),
                AllOf(HasSubstr(name), HasSubstr(":1: "),
                      HasSubstr("a line of over 16777216 bytes, not a text file?")));
  }
}

TEST_F(HostileFiles, with_a_line_that_is_too_long_have_it_named) {
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 #";
  text.append(18 << 20, 'x');
  EXPECT_THAT(message_of<MeshError>([&] { load_mesh(folder_.write("a.obj", text + "\n")); }),
              HasSubstr("a.obj:4: a line of over"));
}

// Their bytes may have no line end among them.
TEST_F(HostileFiles, of_binary_numbers_have_no_lines) {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\n"
      "property uchar z\nelement face 1\nproperty list uchar uchar vertex_indices\n"
      "element rest 18874368\nproperty uchar of_it\nend_header\n";
  for (const char byte : {0, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2}) text += byte;
  text.append(18 << 20, 'x');
  EXPECT_EQ(load_mesh(folder_.write("a.ply", text)).face_count(), 1u);
}

TEST_F(HostileFiles, of_scenes_are_bounded) {
  folder_.write("hole.toml", "");
  std::filesystem::resize_file(folder_ / "hole.toml", std::uintmax_t{1} << 40);
  EXPECT_THAT(message_of<SceneError>([&] { read_scene(folder_ / "hole.toml"); }),
              AllOf(HasSubstr("hole.toml"), HasSubstr("put long paths into a CSV file")));
}

// Calls read(poll) of a kind of file with one that throws at its first call, in the middle and at
// the last; expects some, none later than is promised.
template <class Read>
void expect_to_stop(const char* kind, const Read& read, int least) {
  SCOPED_TRACE(kind);
  int calls = 0;
  test::PollGap gap;
  read([&] { ++calls, gap.poll(); });
  gap.expect_promised();
  EXPECT_GE(calls, least);
  for (const int last : {1, (1 + calls) / 2, calls}) {
    int left = last;
    const auto stop = [&] {
      if (--left == 0) throw Stop();
    };
    EXPECT_THROW(read(stop), Stop) << last;
    EXPECT_EQ(left, 0);
  }
}

TEST_F(HostileFiles, that_are_large_are_stopped_in_the_middle) {
  const Mesh mesh = torus_knot(200, 40).mesh;
  save_obj(mesh, folder_ / "a.obj");
  expect_to_stop(
      "OBJ", [&](const auto& poll) { load_mesh(folder_ / "a.obj", {.poll = poll}); }, 10);

  std::string table = "x,y,z\n";
  while (table.size() < (5u << 20)) table += "0.125,0.25,0.5\n";
  folder_.write("a.csv", table);
  expect_to_stop(
      "CSV", [&](const auto& poll) { read_points(folder_ / "a.csv", 1, {}, poll); }, 5);

  save_cache(test::cache_of(mesh), folder_ / "a.gliss");
  expect_to_stop(
      "cache", [&](const auto& poll) { load_cache(folder_ / "a.gliss", poll); }, 10);

  const auto file = create_result_file(folder_ / "a.h5");
  ResultTable rows(*file, "ticks", Columns().add({"x", "y", "z"}), {}, 3 << 20);
  for (int axis = 0; axis < 3; ++axis) rows.fill(3 << 20, [](std::size_t i) { return 1.0 * i; });
  rows.write();
  file->close();
  expect_to_stop(
      "HDF5", [&](const auto& poll) { read_points(folder_ / "a.h5", 1, {}, poll); }, 9);
}

// HDF5 by hand: what no writer of ours makes.
class HostileHdf5 : public HostileFiles {
 protected:
  static Handle own(hid_t id, Handle::Close close) { return {id, close, "cannot make a test"}; }

  HostileHdf5() {
    write_columns("other.h5", [&](hid_t) {});
    secret_ = folder_.write("secret.txt", "root:hunter2:0:0:/root\n");
  }

  // ticks/x, y and z, a row each, unless `act` makes them first.
  template <class Act>
  std::string write_columns(const std::string& name, const Act& act, bool group = true) const {
    const Handle file =
        own(H5Fcreate((folder_ / name).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    if (group) own(H5Gcreate2(file, "ticks", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    act(file);
    const double value = 0.5;
    for (const char* column : {"ticks/x", "ticks/y", "ticks/z"}) {
      if (!group || H5Lexists(file, column, H5P_DEFAULT) > 0) continue;
      add(file, column, {.rows = 1, .data = &value});
    }
    return folder_ / name;
  }

  struct Added {
    hsize_t rows = 0;
    const double* data = nullptr;
    hid_t creation = H5P_DEFAULT, type = H5T_IEEE_F64LE;
  };
  static void add(hid_t file, const char* name, const Added& added) {
    const hsize_t unlimited = H5S_UNLIMITED;
    const bool chunked =
        added.creation != H5P_DEFAULT && H5Pget_layout(added.creation) == H5D_CHUNKED;
    const Handle space =
        own(H5Screate_simple(1, &added.rows, chunked ? &unlimited : nullptr), H5Sclose);
    const Handle set =
        own(H5Dcreate2(file, name, added.type, space, H5P_DEFAULT, added.creation, H5P_DEFAULT),
            H5Dclose);
    if (added.data == nullptr) return;
    ASSERT_GE(H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, added.data), 0);
  }
  static Handle chunks_of(hsize_t rows, bool deflated) {
    Handle creation = own(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(creation, 1, &rows);
    if (deflated) H5Pset_deflate(creation, 9);
    return creation;
  }

  static std::string refusal(const std::string& path) {
    return message_of<RecordingError>([&] { read_points(path, 1); });
  }

  std::string secret_;
};

TEST_F(HostileHdf5, of_one_row_is_read) {
  EXPECT_THAT(read_points(folder_ / "other.h5", 1).points, ElementsAre(Vec3(0.5, 0.5, 0.5)));
}

TEST_F(HostileHdf5, that_links_to_another_file_is_refused_by_name) {
  const std::string group = write_columns(
      "group.h5",
      [](hid_t file) {
        H5Lcreate_external("other.h5", "/ticks", file, "ticks", H5P_DEFAULT, H5P_DEFAULT);
      },
      false);
  EXPECT_THAT(refusal(group),
              AllOf(HasSubstr("group.h5"), HasSubstr("'ticks/x'"),
                    HasSubstr("linked to another file, 'other.h5', which is not read")));
  const std::string column = write_columns("column.h5", [](hid_t file) {
    H5Lcreate_external("other.h5", "/ticks/x", file, "ticks/y", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_THAT(refusal(column), AllOf(HasSubstr("column 'ticks/y'"), HasSubstr("'other.h5'")));
  const std::string soft = write_columns("soft.h5", [](hid_t file) {
    H5Lcreate_external("other.h5", "/", file, "away", H5P_DEFAULT, H5P_DEFAULT);
    H5Lcreate_soft("/away/ticks/x", file, "ticks/x", H5P_DEFAULT, H5P_DEFAULT);
  });
  EXPECT_THAT(refusal(soft), AllOf(HasSubstr("column 'ticks/x'"), HasSubstr("'other.h5'")));
}

TEST_F(HostileHdf5, with_raw_data_in_another_file_is_refused_by_name) {
  const std::string pipe = folder_ / "pipe";  // where opening it would wait for ever
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& raw : {secret_, pipe}) {
    const std::string path = write_columns("raw.h5", [&](hid_t file) {
      const Handle creation = own(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
      H5Pset_external(creation, raw.c_str(), 0, 16);
      add(file, "ticks/z", {.rows = 16, .creation = creation, .type = H5T_STD_U8LE});
    });
    EXPECT_THAT(refusal(path), AllOf(HasSubstr("raw.h5"), HasSubstr("column 'ticks/z'"),
                                     HasSubstr("in another file, which is not read")));
  }
}

TEST_F(HostileHdf5, with_virtual_columns_of_another_file_is_refused_by_name) {
  const std::string path = write_columns("virtual.h5", [&](hid_t file) {
    const hsize_t rows = 1;
    const Handle creation = own(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    const Handle space = own(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    H5Pset_virtual(creation, space, "other.h5", "/ticks/x", space);
    add(file, "ticks/x", {.rows = rows, .creation = creation});
  });
  EXPECT_THAT(refusal(path), AllOf(HasSubstr("column 'ticks/x'"), HasSubstr("in another file")));
}

TEST_F(HostileHdf5, that_claims_more_rows_than_are_stored_is_refused) {
  const std::string path = write_columns("rows.h5", [](hid_t file) {
    const std::vector<double> values(1 << 14, 0.01);
    for (const char* column : {"ticks/x", "ticks/y", "ticks/z"}) {
      add(file, column,
          {.rows = 1 << 14, .data = values.data(), .creation = chunks_of(1 << 14, false)});
      const Handle set = own(H5Dopen2(file, column, H5P_DEFAULT), H5Dclose);
      const hsize_t claimed = 2'100'000'000;
      H5Dset_extent(set, &claimed);
    }
  });
  EXPECT_THAT(refusal(path), AllOf(HasSubstr("rows.h5"), HasSubstr("column 'ticks/x'"),
                                   HasSubstr("2100000000 rows, of which 16384 are stored")));
  const std::string unwritten =
      write_columns("none.h5", [](hid_t file) { add(file, "ticks/x", {.rows = 2'100'000'000}); });
  EXPECT_THAT(refusal(unwritten), HasSubstr("2100000000 rows, of which 0 are stored"));
}

TEST_F(HostileHdf5, that_unpacks_to_far_more_than_it_has_is_refused) {
  const std::string bomb = write_columns("bomb.h5", [](hid_t file) {
    const std::vector<double> zeros(1 << 25);
    add(file, "ticks/x",
        {.rows = zeros.size(), .data = zeros.data(), .creation = chunks_of(1 << 20, true)});
  });
  EXPECT_LT(std::filesystem::file_size(bomb), 2u << 20);
  EXPECT_THAT(refusal(bomb), AllOf(HasSubstr("column 'ticks/x'"),
                                   HasSubstr("268435456 bytes unpacked, too many for a file of")));
  // A few rows in a chunk that is unpacked as a whole.
  const std::string chunk = write_columns("chunk.h5", [](hid_t file) {
    const double value = 1;
    add(file, "ticks/x", {.rows = 1, .data = &value, .creation = chunks_of(1 << 25, true)});
  });
  EXPECT_THAT(refusal(chunk), HasSubstr("268435456 bytes unpacked"));
}

// A chunk's bytes unpack to more than the file says of it.
TEST_F(HostileHdf5, with_a_chunk_that_unpacks_to_more_than_its_rows_is_read_as_far_as_they_go) {
  const std::string path = write_columns("more.h5", [](hid_t file) {
    const std::vector<double> values(1 << 20, 0.25);
    const Handle creation = chunks_of(values.size(), true);
    add(file, "long", {.rows = values.size(), .data = values.data(), .creation = creation});
    const Handle from = own(H5Dopen2(file, "long", H5P_DEFAULT), H5Dclose);
    const hsize_t begin = 0;
    hsize_t bytes = 0;
    H5Dget_chunk_storage_size(from, &begin, &bytes);
    std::vector<char> packed(bytes);
    std::uint32_t left_out = 0;
    H5Dread_chunk(from, H5P_DEFAULT, &begin, &left_out, packed.data());
    for (const char* column : {"ticks/x", "ticks/y", "ticks/z"}) {
      add(file, column, {.rows = 2, .creation = chunks_of(2, true)});
      const Handle to = own(H5Dopen2(file, column, H5P_DEFAULT), H5Dclose);
      ASSERT_GE(H5Dwrite_chunk(to, H5P_DEFAULT, 0, &begin, bytes, packed.data()), 0);
    }
  });
  const Vec3 all(0.25, 0.25, 0.25);
  EXPECT_THAT(read_points(path, 1).points, ElementsAre(all, all));
}

// A hand at rest for an hour is no bomb.
TEST_F(HostileHdf5, that_unpacks_to_much_is_read_whole) {
  const std::vector<double> rest(3'600'000, 0.25);
  const std::string path = write_columns("rest.h5", [&](hid_t file) {
    for (const char* column : {"ticks/x", "ticks/y", "ticks/z"}) {
      add(file, column,
          {.rows = rest.size(), .data = rest.data(), .creation = chunks_of(1 << 14, true)});
    }
  });
  const auto points = read_points(path, 1).points;
  ASSERT_EQ(points.size(), rest.size());
  for (const Vec3& point : points) ASSERT_EQ(point, Vec3(0.25, 0.25, 0.25));
}

// HDF5 1.10 reads them through heaps that it does not check: a heap of nothing makes it hang, and a
// row that refers to a longer text makes it write past its memory.
TEST_F(HostileHdf5, with_texts_of_variable_length_is_refused) {
  const std::string path = write_columns("texts.h5", [&](hid_t file) {
    const Handle text = own(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(text, H5T_VARIABLE);
    const hsize_t rows = 2;
    const Handle space = own(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    const Handle set = own(
        H5Dcreate2(file, "method", text, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    const char* texts[] = {"gregory", "flat"};
    H5Dwrite(set, text, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts);
    const Handle scalar = own(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle unit =
        own(H5Acreate2(file, "unit", text, scalar, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    H5Awrite(unit, text, texts);
  });
  std::string heap = folder_.read("texts.h5");
  heap.replace(heap.find("GCOL") + 16, 64, 64, '\0');  // objects of no size, behind its header
  for (const std::string& name : {path, folder_.write("heap.h5", heap)}) {
    const Hdf5Reader file(name, "a trace");
    EXPECT_THAT(message_of<std::runtime_error>([&] { file.texts("method"); }),
                AllOf(HasSubstr(name + "' as a trace: column 'method': "),
                      HasSubstr("its rows are not texts of a fixed length")));
    EXPECT_EQ(file.text_attribute("unit"), std::nullopt);
    EXPECT_EQ(file.number_attribute("unit"), std::nullopt);
    EXPECT_EQ(file.rows("method"), 2u);
  }
}

// Other programs fill them with blanks, end them by a zero, or fill them up.
TEST_F(HostileHdf5, with_texts_of_a_fixed_length_is_read) {
  const std::string path = write_columns("texts.h5", [&](hid_t file) {
    for (const auto& [name, padding] :
         {std::pair{"blanks", H5T_STR_SPACEPAD}, {"zero", H5T_STR_NULLTERM}}) {
      const Handle text = own(H5Tcopy(H5T_C_S1), H5Tclose);
      H5Tset_size(text, 4);
      H5Tset_strpad(text, padding);
      const hsize_t rows = 3;
      const Handle space = own(H5Screate_simple(1, &rows, nullptr), H5Sclose);
      const Handle set =
          own(H5Dcreate2(file, name, text, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
      H5Dwrite(set, text, H5S_ALL, H5S_ALL, H5P_DEFAULT,
               padding == H5T_STR_SPACEPAD ? "a   bc  defg" : "a\0xxbc\0xdef");
    }
  });
  const Hdf5Reader file(path, "a trace");
  EXPECT_THAT(file.texts("blanks"), ElementsAre("a", "bc", "defg"));
  EXPECT_THAT(file.texts("zero"), ElementsAre("a", "bc", "def"));
}

// One long text unpacks to far more than the file has.
TEST_F(HostileHdf5, with_one_long_text_many_times_is_refused) {
  const std::string path = write_columns("texts.h5", [&](hid_t file) {
    const hsize_t rows = 200;
    const Handle text = hdf5::text_type(1 << 20), creation = chunks_of(20, true),
                 space = own(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    const Handle set =
        own(H5Dcreate2(file, "method", text, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
    const std::string texts(rows << 20, 'x');
    H5Dwrite(set, text, H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data());
  });
  EXPECT_THAT(message_of<std::runtime_error>([&] { Hdf5Reader(path, "a trace").texts("method"); }),
              AllOf(HasSubstr("texts.h5' as a trace: column 'method': "),
                    HasSubstr("209715200 bytes unpacked, too many for a file of")));
}

TEST_F(HostileHdf5, that_lacks_a_column_has_it_named) {
  const Hdf5Reader file(folder_ / "other.h5", "a recording");
  EXPECT_THAT(message_of<std::runtime_error>([&] { file.numbers("ticks/sent_x"); }),
              HasSubstr("other.h5' as a recording: column 'ticks/sent_x': it is not there"));
}

// Names of up to 255 bytes, which leave no room for an ending.
TEST(LongNames, leave_room_for_an_ending_and_stay_apart) {
  EXPECT_EQ(with_ending("a/b.csv", ".parts"), "a/b.csv.parts");
  const std::string folder(300, 'f'), name(254, 'n');
  const std::string one = with_ending(folder + "/" + name + "1", ".parts"),
                    other = with_ending(folder + "/" + name + "2", ".parts");
  EXPECT_THAT(one, AllOf(StartsWith(folder + "/nnnnnn"), ::testing::EndsWith(".parts")));
  EXPECT_EQ(one.size(), folder.size() + 1 + 255);
  EXPECT_NE(one, other);
  // Not in the middle of a character.
  for (std::size_t lead = 0; lead < 3; ++lead) {
    std::string euros(lead, 'e');
    while (euros.size() < 253) euros += "\xe2\x82\xac";
    const std::string cut = with_ending(euros, ".gliss-tmp0");
    EXPECT_LE(cut.size(), 255u);
    EXPECT_EQ((cut.find('~') - lead) % 3, 0u);
  }
}

TEST(LongNames, are_written) {
  const test::ScratchFolder folder;
  for (std::size_t size = 240; size <= 255; ++size) {
    const std::string name(size, 'n');
    AtomicFile file(folder / name);
    file.write("text");
    EXPECT_EQ(folder.file_count(), 1u);  // the temporary
    file.commit();
    EXPECT_EQ(folder.read(name), "text");
    std::filesystem::remove(folder / name);
  }
  EXPECT_THAT(message_of<std::system_error>([&] { AtomicFile(folder / std::string(256, 'n')); }),
              HasSubstr("File name too long"));
}

// A gigabyte of which one block was written.
TEST_F(HostileFiles, that_are_hollow_are_refused_and_large_ones_that_are_written_are_read) {
  const std::string path = folder_ / "mesh.stl";
  std::ofstream(path) << std::string(4096, 'x');
  std::filesystem::resize_file(path, 1 << 30);
  EXPECT_THAT(message_of<NoFileError>([&] { OpenFile(path).check(); }),
              HasSubstr("mesh.stl': it says to have 1073741824 bytes"));
  std::filesystem::resize_file(path, 32 << 20);
  EXPECT_NO_THROW(OpenFile(path).check());  // read within a moment
  std::ofstream(path) << std::string(4 << 20, 'x');
  std::filesystem::resize_file(path, 128 << 20);
  OpenFile file(path);
  file.check();
  EXPECT_EQ(file.read_all().size(), 128u << 20);
}

}  // namespace
}  // namespace gliss
