// Every file of bad_meshes/, as the library and as gliss check see it, against its line of
// EXPECTED.txt.
#include <locale>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "gliss/build/build_cache.h"
#include "gliss/files/mesh_file.h"
#include "gliss/surface/patch_cache.h"
#include "tests/support/german_locale.h"
#include "tests/support/mesh_files.h"
#include "tests/support/places.h"
#include "tests/support/require.h"
#include "tests/support/run_files.h"

namespace gliss {
namespace {

using ::testing::AllOf, ::testing::AnyOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;
namespace fs = std::filesystem;

const fs::path kFolder = fs::path(test::kTests) / "bad_meshes";
const std::string kManifest = "EXPECTED.txt";

// The verdict that a user is told of a mesh: its state, then "code | place | count" of each
// finding, sorted.
using Verdict = std::vector<std::string>;

std::string place_text(std::size_t line, std::uint32_t face, std::uint32_t vertex) {
  std::string text = line ? fmt::format("line {} ", line) : "";
  if (face != kNone) {
    text += fmt::format("face {} ", face);
  } else if (vertex != kNone) {
    text += fmt::format("vertex {} ", vertex);
  }
  return text.empty() ? "-" : text.substr(0, text.size() - 1);
}

Verdict verdict_of(const std::string& state, Verdict findings) {
  std::sort(findings.begin(), findings.end());
  findings.insert(findings.begin(), state);
  return findings;
}

// A strict check's verdict is on a line of its own if it is another.
constexpr std::string_view kStrictly = "strict ";

std::map<std::string, Verdict> read_manifest(bool strict) {
  std::map<std::string, Verdict> expected;
  std::ifstream file(kFolder / kManifest);
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.starts_with('#') || line.starts_with(kStrictly) != strict) continue;
    if (strict) line = line.substr(kStrictly.size());
    std::vector<std::string> words;
    for (const std::string& word : test::split(line, '|')) {
      words.push_back(std::regex_replace(word, std::regex("^ +| +$"), ""));
    }
    Verdict findings;
    for (std::size_t i = 2; i + 2 < words.size(); i += 3) {
      findings.push_back(fmt::format("{} | {} | {}", words[i], words[i + 1], words[i + 2]));
    }
    EXPECT_EQ(words.size() % 3, 2u) << line;
    const bool is_new = expected.emplace(words.at(0), verdict_of(words.at(1), findings)).second;
    EXPECT_TRUE(is_new) << words[0] << " has two lines";
  }
  return expected;
}

const std::map<std::string, Verdict>& expected() {
  static const std::map<std::string, Verdict> manifest = read_manifest(false);
  return manifest;
}
const std::map<std::string, Verdict>& expected_strictly() {
  static const std::map<std::string, Verdict> manifest = read_manifest(true);
  return manifest;
}

std::string bytes_of_file(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// "file:line: face N: ..." where these are known.
void expect_place_in_message(const Finding& finding, const std::string& path) {
  std::string start = path;
  if (finding.line) start += fmt::format(":{}", finding.line);
  if (finding.face != kNone) {
    start += fmt::format(": face {}", finding.face);
  } else if (finding.vertex != kNone) {
    start += fmt::format(": vertex {}", finding.vertex);
  }
  EXPECT_THAT(finding.message, StartsWith(start + ": "));
  EXPECT_LT(finding.message.size(), path.size() + 300);
}

// The library's verdict; what it accepts must also be built.
Verdict verdict_of_library(const std::string& path, const LoadOptions& options = {}) {
  std::vector<Finding> findings;
  std::string state = "accepted";
  try {
    build_cache(load_mesh(path, options, &findings));
  } catch (const MeshError& error) {
    state = "refused";
    const auto is_error = [](const Finding& f) { return f.severity == Severity::kError; };
    const auto first = std::find_if(findings.begin(), findings.end(), is_error);
    EXPECT_TRUE(first != findings.end() && first->message == error.what());
  }
  Verdict lines;
  for (const Finding& f : findings) {
    EXPECT_TRUE(f.severity != Severity::kError || state == "refused");
    if (f.severity == Severity::kWarning && state == "accepted") state = "warned";
    if (f.severity == Severity::kRepaired && state != "refused") state = "repaired";
    lines.push_back(
        fmt::format("{} | {} | {}", f.code, place_text(f.line, f.face, f.vertex), f.count));
    expect_place_in_message(f, path);
  }
  return verdict_of(state, lines);
}

class BadMesh : public MeshFiles {
 protected:
  Verdict verdict(const std::string& name, const std::string& text) {
    return verdict_of_library(folder_.write(name, text));
  }

  // Expects the same of the text files among them with other line endings; returns how many these
  // are.
  std::size_t expect_same_with(const std::string& line_end) {
    std::size_t count = 0;
    for (const auto& [name, wanted] : expected()) {
      const std::string text = bytes_of_file(kFolder / name);
      const bool binary = text.find('\0') != text.npos || text.starts_with("\x1f\x8b") ||
                          text.find("\nformat binary") != text.npos;
      if (binary) continue;
      const std::string changed = std::regex_replace(text, std::regex("\r\n|\n"), line_end);
      EXPECT_EQ(verdict(name, changed), wanted) << name;
      ++count;
    }
    return count;
  }
};

TEST_F(BadMesh, every_file_has_a_line_and_every_line_a_file) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(kFolder)) {
    const std::string name = entry.path().filename();
    if (name == kManifest) continue;
    EXPECT_TRUE(expected().contains(name)) << name << " has no line";
    ++files;
  }
  for (const auto& [name, wanted] : expected()) {
    EXPECT_TRUE(fs::exists(kFolder / name)) << name << " is missing";
    EXPECT_THAT(wanted[0], ::testing::AnyOf("accepted", "warned", "repaired", "refused")) << name;
    EXPECT_EQ(wanted.size() == 1, wanted[0] == "accepted") << name;
  }
  EXPECT_EQ(files, expected().size());
  EXPECT_GE(files, 120u);
}

TEST_F(BadMesh, every_code_that_a_file_can_give_is_among_them) {
  std::string manifest;
  for (const auto* lines : {&expected(), &expected_strictly()}) {
    for (const auto& [name, verdict] : *lines) {
      for (const std::string& line : verdict) manifest += "\n" + line;
    }
  }
  for (const char* code : {"unsupported",
                           "syntax",
                           "truncated",
                           "extra-data",
                           "count-mismatch",
                           "no-faces",
                           "non-finite",
                           "huge-coordinate",
                           "vertex-index",
                           "normal-index",
                           "too-few-vertices",
                           "too-many-sides",
                           "self-touching-face",
                           "zero-length-side",
                           "zero-area-face",
                           "non-orientable",
                           "non-manifold-edge",
                           "non-manifold-vertex",
                           "welded-vertices",
                           "facet-normals",
                           "repeated-corner",
                           "duplicate-face",
                           "flipped-face",
                           "inside-out-part",
                           "zero-normal",
                           "missing-normal",
                           "non-unit-normal",
                           "unknown-statement",
                           "ignored-weight",
                           "extra-columns",
                           "unused-normals",
                           "unused-vertices",
                           "coincident-vertices",
                           "several-parts",
                           "parts-intersect",
                           "part-inside-part",
                           "cavity",
                           "faces-inward",
                           "doubled-face",
                           "fold",
                           "no-volume",
                           "open-border",
                           "concave",
                           "non-planar",
                           "sharp-normals",
                           "normals-against-face"}) {
    EXPECT_THAT(manifest, HasSubstr(fmt::format("\n{} | ", code)));
  }
}

TEST_F(BadMesh, each_gets_the_verdict_of_its_line) {
  for (const auto& [name, wanted] : expected()) {
    EXPECT_EQ(verdict_of_library(kFolder / name), wanted) << name;
  }
}

TEST_F(BadMesh, a_strict_check_mends_nothing_that_costs_faces_or_vertices) {
  EXPECT_GE(expected_strictly().size(), 30u);
  for (const auto& [name, wanted] : expected()) {
    const auto strictly = expected_strictly().find(name);
    EXPECT_EQ(verdict_of_library(kFolder / name, {.strict = true}),
              strictly == expected_strictly().end() ? wanted : strictly->second)
        << name;
  }
}

TEST_F(BadMesh, line_endings_make_no_difference) {
  EXPECT_GT(expect_same_with("\r\n"), 300u);
  EXPECT_GT(expect_same_with("\r"), 300u);
}

TEST_F(BadMesh, a_locale_with_a_comma_makes_no_difference) {
  struct Comma : std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
  };
  expected();  // read before
  const test::GermanLocale locale;
  const std::string c_before = std::setlocale(LC_ALL, nullptr);
  const std::locale before = std::locale::global(std::locale(std::locale(), new Comma));
  const bool german = locale.made() && locale.set_environment() && std::setlocale(LC_ALL, "");
  EXPECT_EQ(fmt::format("{}", std::localeconv()->decimal_point), german ? "," : ".");
  for (const auto& [name, wanted] : expected()) {
    EXPECT_EQ(verdict_of_library(kFolder / name), wanted) << name;
  }
  std::locale::global(before);
  std::setlocale(LC_ALL, c_before.c_str());
  if (!locale.made()) GLISS_SKIP_UNLESS_REQUIRED(test::GermanLocale::kAbsent);
}

TEST_F(BadMesh, gliss_check_says_the_same_and_ends_with_0_or_2) {
  for (const auto& [name, wanted] : expected()) {
    SCOPED_TRACE(name);
    test::Process process(kFolder, test::kProgram, {"check", name, "--json", "--threads", "1"});
    const test::Outcome outcome = process.wait();
    const bool refused = wanted[0] == "refused";
    EXPECT_EQ(outcome.code, refused ? 2 : 0);
    if (refused) {
      EXPECT_THAT(outcome.err, StartsWith("gliss: " + name + ":"));
      EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1);
    } else {
      for (const std::string& line : test::split(outcome.err, '\n')) {
        EXPECT_THAT(line,
                    AnyOf("", AllOf(HasSubstr("radius of curvature"), EndsWith("jumps there")),
                          HasSubstr(" across: "), HasSubstr(" are kept sharp; "),
                          HasSubstr(" a hand feels another shape "), StartsWith("build: ")));
      }
    }
    const auto json = nlohmann::json::parse(outcome.out, nullptr, false);
    ASSERT_TRUE(json.is_object()) << outcome.out;
    EXPECT_EQ(json.at("accepted"), !refused);
    Verdict lines;
    for (const auto& finding : json.at("findings")) {
      const auto number = [&]<class T>(const char* key, T none) {
        return finding.at(key).is_null() ? none : finding.at(key).get<T>();
      };
      lines.push_back(fmt::format("{} | {} | {}", finding.at("code").get<std::string>(),
                                  place_text(number("line", std::size_t{0}), number("face", kNone),
                                             number("vertex", kNone)),
                                  finding.at("count").get<std::size_t>()));
    }
    EXPECT_EQ(verdict_of(json.at("state"), lines), wanted);
  }
}

TEST_F(BadMesh, gliss_check_tells_people_severity_code_count_and_place) {
  const auto told = [](const std::string& name) {
    return test::Process(kFolder, test::kProgram, {"check", name}).wait().out;
  };
  EXPECT_THAT(told("obj_duplicate_then_concave.obj"),
              ::testing::ContainsRegex(
                  "repaired +duplicate-face +1  obj_duplicate_then_concave.obj:10: face 1: is face "
                  "0 again and removed\n"));
  EXPECT_THAT(told("obj_duplicate_then_concave.obj"), HasSubstr(".obj: repaired\n"));
  EXPECT_THAT(
      told("obj_bow_tie.obj"),
      ::testing::ContainsRegex("repaired +non-manifold-vertex +1  obj_bow_tie.obj:7: face 1: "));
  EXPECT_THAT(told("obj_bow_tie.obj"), HasSubstr("obj_bow_tie.obj: repaired\n"));
  EXPECT_THAT(told("obj_moebius.obj"), HasSubstr("obj_moebius.obj: refused\n"));
  EXPECT_THAT(told("obj_lf.obj"), HasSubstr("nothing found\nobj_lf.obj: accepted\n"));
}

const std::string kTetrahedron =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string kLong(10'000'000, 'x');

TEST_F(BadMesh, lines_of_10_megabytes_are_read_and_not_repeated) {
  const std::string blanks(10'000'000, ' ');
  const auto refused = [](const char* what) { return ElementsAre("refused", what); };
  EXPECT_THAT(verdict("a.obj", "# " + kLong + "\n" + kTetrahedron), ElementsAre("accepted"));
  EXPECT_THAT(verdict("a.obj", "g " + kLong + "\n" + kTetrahedron), ElementsAre("accepted"));
  EXPECT_THAT(verdict("a.obj", "v 0" + blanks + "0 0\n" + kTetrahedron.substr(8)),
              ElementsAre("accepted"));
  EXPECT_THAT(verdict("a.obj", kLong + "\n" + kTetrahedron),
              ElementsAre("warned", "unknown-statement | line 1 | 1"));
  EXPECT_THAT(verdict("a.obj", "v 0 0 " + kLong), refused("syntax | line 1 | 1"));
  EXPECT_THAT(verdict("a.obj", "v 0 0 1" + std::string(10'000'000, '0') + "\n" + kTetrahedron),
              refused("non-finite | line 1 vertex 0 | 1"));
  EXPECT_THAT(verdict("a.obj", kTetrahedron + "f 1 2 3/" + kLong),
              refused("syntax | line 9 face 4 | 1"));
  EXPECT_THAT(verdict("a.obj", kTetrahedron + "f 1 2 " + std::string(10'000'000, '9')),
              refused("vertex-index | line 9 face 4 | 1"));
  EXPECT_THAT(verdict("a.off", kLong), refused("syntax | line 1 | 1"));
  EXPECT_THAT(verdict("a.off", "OFF\n" + kLong), refused("syntax | line 2 | 1"));
  EXPECT_THAT(verdict("a.off", "OFF\n1 0\n0 0 0 " + kLong), refused("extra-data | line 3 | 1"));
  EXPECT_THAT(verdict("a.ply", "ply\nformat ascii 1.0\nelement " + kLong +
                                   " 9\nproperty int x\nend_header\n"),
              refused("truncated | - | 1"));
  EXPECT_THAT(verdict("a.ply", kLong), refused("syntax | line 1 | 1"));
  EXPECT_THAT(verdict("a.ply", "ply\n" + kLong), refused("syntax | line 2 | 1"));
  EXPECT_THAT(
      verdict("a.ply", "ply\nformat ascii 1.0\ncomment " + kLong + "\nelement " + kLong + " 1"),
      refused("truncated | - | 1"));
}

TEST_F(BadMesh, a_face_of_a_million_corners_is_refused) {
  std::string face = "f";
  for (int i = 0; i < 1'000'000; ++i) face += fmt::format(" {}", 1 + i % 4);
  EXPECT_THAT(verdict("a.obj", kTetrahedron + face),
              ElementsAre("refused", "too-many-sides | line 9 face 4 | 1"));
}

TEST_F(BadMesh, a_million_empty_lines_are_counted) {
  const std::string lines(1'000'000, '\n');
  EXPECT_THAT(verdict("a.obj", lines + kTetrahedron + lines), ElementsAre("accepted"));
  EXPECT_THAT(verdict("a.obj", lines + "v 0 0 x"),
              ElementsAre("refused", "syntax | line 1000001 | 1"));
  EXPECT_THAT(verdict("a.off", "OFF" + lines + "1 0\n0 0\n"),
              ElementsAre("refused", "syntax | line 1000002 | 1"));
}

TEST_F(BadMesh, counts_up_to_2_to_64_are_believed_only_as_far_as_the_file_goes) {
  for (const char* count : {"1000000000", "4294967296", "4294967297", "9223372036854775807",
                            "9223372036854775808", "18446744073709551617"}) {
    EXPECT_THAT(verdict("a.off", fmt::format("OFF\n{} 1 0\n0 0 0\n", count)),
                ElementsAre("refused", "truncated | - | 1"));
    EXPECT_THAT(verdict("a.off", fmt::format("OFF\n1 {} 0\n0 0 0\n", count)),
                ElementsAre("refused", "truncated | - | 1"));
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      for (const char* element : {"vertex", "face", "other"}) {
        const std::string text = fmt::format(
            "ply\nformat {} 1.0\nelement {} {}\nproperty float x\nproperty float y\n"
            "property float z\nproperty list uchar int vertex_indices\nend_header\n",
            format, element, count);
        EXPECT_THAT(verdict("a.ply", text), ElementsAre("refused", "truncated | - | 1"))
            << format << ' ' << element << ' ' << count;
      }
    }
  }
}

}  // namespace
}  // namespace gliss
