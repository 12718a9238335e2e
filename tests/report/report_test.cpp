// Holds what gliss report puts into its page, and what it refuses.
#include <cstring>

#include "gliss/files/mesh_file.h"
#include "tests/support/places.h"
#include "tests/support/require.h"
#include "tests/support/run_files.h"

namespace gliss {
namespace {

using test::Outcome;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;

constexpr char kTraceHeader[] = "step,method,x,y,z,scp_x,scp_y,scp_z,fx,fy,fz,patch,state\n";

std::vector<unsigned char> from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<unsigned char> bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    group = group << 6 | static_cast<std::uint32_t>(digits.find(c));
    if ((bits += 6) >= 8) bytes.push_back(static_cast<unsigned char>(group >> (bits -= 8)));
  }
  return bytes;
}

std::vector<float> floats(const nlohmann::json& packed) {
  const auto bytes = from_base64(packed.at("f32"));
  std::vector<float> values(bytes.size() / sizeof(float));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(float));
  return values;
}

// Holds what columns in 16 bits give back, and how far a value may be off.
struct Quantised {
  std::vector<double> values, tolerance;

  explicit Quantised(const nlohmann::json& json) {
    const auto bytes = from_base64(json.at("i16"));
    std::vector<std::int16_t> steps(bytes.size() / sizeof(std::int16_t));
    std::memcpy(steps.data(), bytes.data(), steps.size() * sizeof(std::int16_t));
    const std::size_t columns = json.at("scale").size();
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const double scale = json.at("scale")[i % columns], offset = json.at("offset")[i % columns];
      values.push_back(steps[i] == -32768 ? std::nan("") : offset + scale * steps[i]);
      tolerance.push_back(0.501 * scale);
    }
  }
  void expect(std::size_t i, double value) const {
    if (std::isnan(value) || value == 0) {
      EXPECT_THAT(values[i], ::testing::NanSensitiveDoubleEq(value));
    } else {
      EXPECT_NEAR(values[i], value, tolerance[i]);
    }
  }
};

class Report : public test::RunTest {
 protected:
  Report() { save_obj(goldberg().mesh, folder_ / "ball.obj"); }
  void SetUp() override {
#ifndef GLISS_WITH_REPORT
    GLISS_SKIP_UNLESS_REQUIRED("this build has no report");
#endif
  }

  Outcome gliss(const std::string& command, const std::string& words) const {
    return start(command, words)->wait();
  }
  void make(const std::string& command, const std::string& words) const {
    const Outcome outcome = gliss(command, words + " --quiet");
    ASSERT_EQ(outcome.code, 0) << words << ": " << outcome.err;
  }
  // The results as the page holds them.
  nlohmann::json results_of(const std::string& words) const {
    make("report", words + " -o page.html");
    const std::string page = folder_.read("page.html");
    const std::string opening = "<script type=\"application/json\" id=\"results\">";
    const auto begin = page.find(opening) + opening.size(), end = page.find("</script>", begin);
    const auto json = nlohmann::json::parse(page.substr(begin, end - begin), nullptr, false);
    EXPECT_TRUE(json.is_object());
    return json.value("results", nlohmann::json());
  }
  nlohmann::json result_of(const std::string& words) const {
    const auto results = results_of(words);
    EXPECT_EQ(results.size(), 1u);
    return results.at(0);
  }
  void expect_refused(const std::string& words, const std::string& what) const {
    expect_error(gliss("report", words + " -o page.html"), 2, what);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "page.html")) << words;
  }
};

TEST_F(Report, BarsAreTheStepsOfForceToZeroAndBackToo) {
  folder_.write("forces.csv", std::string(kTraceHeader) +
                                  "10,flat,0,0,0,0,0,0,0,0,1,3,contact\n"
                                  "11,flat,0,0,0,0,0,0,0,0,3,3,contact\n"
                                  "12,flat,0,0,0,0,0,0,0,0,0,3,free\n"
                                  "13,flat,0,0,0,0,0,0,0,4,0,3,contact\n"
                                  "14,flat,7,8,9,0,0,0,3,4,0,5,contact\n"
                                  "10,gregory,0,0,0,0,0,0,0,0,1,3,contact\n"
                                  "11,gregory,0,0,0,0,0,0,0,0,1.5,3,contact\n");
  const auto result = result_of("forces.csv");
  EXPECT_EQ(result["kind"], "trace");
  EXPECT_EQ(result["file"], "forces.csv");
  EXPECT_EQ(result["first_step"], 10);
  EXPECT_EQ(result["last_step"], 14);
  const auto& flat = result["methods"][0];
  EXPECT_EQ(flat["method"], "flat");
  EXPECT_EQ(flat["ticks"], 5);
  EXPECT_EQ(flat["in_contact"], 4);
  EXPECT_EQ(flat["mean_change"], 3);
  EXPECT_EQ(flat["jumps_per_100k"], 1e5);
  EXPECT_EQ(flat["lost_per_100k"], 0.25e5);
  EXPECT_EQ(flat["unsound"], 0);
  EXPECT_EQ(flat["largest_force"], 5);
  EXPECT_EQ(flat["deepest"], std::sqrt(7.0 * 7 + 8 * 8 + 9 * 9));
  EXPECT_EQ(flat["largest"][0]["step"], 13);
  EXPECT_EQ(flat["largest"][0]["change"], 4);
  EXPECT_THAT(floats(flat["step"]), ElementsAre(11, 12, 13, 14));
  EXPECT_THAT(floats(flat["change"]), ElementsAre(2, 3, 4, 3));
  EXPECT_THAT(floats(flat["force"]), ElementsAre(3, 0, 4, 5));
  EXPECT_THAT(floats(flat["z"]), ElementsAre(0, 0, 0, 9));
  const auto& gregory = result["methods"][1];
  EXPECT_EQ(gregory["method"], "gregory");
  EXPECT_THAT(floats(gregory["change"]), ElementsAre(0.5f));
}

TEST_F(Report, NeverTakesWhatIsNotFiniteForASmallStep) {
  for (const std::string force : {"nan", "inf", "-inf"}) {
    folder_.write("forces.csv", std::string(kTraceHeader) + "0,flat,0,0,0,0,0,0,0,0,1,1,contact\n" +
                                    "1,flat,0,0,0,0,0,0,0,0," + force + ",1,contact\n");
    expect_refused("forces.csv", "forces.csv:3: column 'fz': '" + force + "' is not finite");
  }
}

TEST_F(Report, TracesInCsvAndHdf5AreTheSame) {
  const std::string words = "ball.obj --path hand.csv --unit mm -o ";
  make("trace", words + "forces.csv");
  make("trace", words + "forces.h5");
  auto results = results_of("forces.csv forces.h5");
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0]["methods"].size(), 3u);
  EXPECT_EQ(results[0]["methods"], results[1]["methods"]);
  EXPECT_EQ(results[1]["origin"]["surface"], "ball.obj");
  EXPECT_EQ(results[1]["origin"]["unit"], "mm");
  EXPECT_EQ(results[1]["origin"]["stiffness_N_per_m"], 500);
  EXPECT_THAT(results[1]["origin"]["command_line"].get<std::string>(),
              HasSubstr("gliss trace ball.obj"));
}

TEST_F(Report, LongPathsAreThinnedToTheirExtremes) {
  constexpr int kTicks = 200000, kPeak = 123456;
  std::string rows = kTraceHeader;
  for (int tick = 0; tick < kTicks; ++tick) {
    rows += fmt::format("{},gregory,0,0,0,0,0,0,{},0,0,1,contact\n", tick,
                        tick < kPeak ? 0.001 * (tick % 2) : 2);
  }
  folder_.write("long.csv", rows);
  const auto method = result_of("long.csv")["methods"][0];
  EXPECT_EQ(method["ticks"], kTicks);
  const auto step = floats(method["step"]), change = floats(method["change"]);
  ASSERT_EQ(step.size(), change.size());
  EXPECT_LE(step.size(), 20000u);
  EXPECT_GT(step.size(), 10000u);
  EXPECT_TRUE(std::is_sorted(step.begin(), step.end()));
  const auto peak = std::max_element(change.begin(), change.end());
  EXPECT_FLOAT_EQ(*peak, 1.999f);
  EXPECT_EQ(step[static_cast<std::size_t>(peak - change.begin())], kPeak);
}

TEST_F(Report, SweepsKeepPointsForcesAndDistributions) {
  const std::string words = "ball.obj --depth 1mm,2mm --rings 3 --unit mm ";
  make("sweep", words + "-o ball.h5");
  make("sweep", words + "-o ball.csv");
  const auto result = result_of("ball.h5");
  EXPECT_EQ(result["kind"], "sweep");
  ASSERT_EQ(result["depths"].size(), 2u);
  const test::TextTable table(folder_.read("ball.csv"));
  for (const auto& depth : result["depths"]) {
    const std::size_t samples = depth["samples"];
    EXPECT_EQ(depth["shown"], samples);
    ASSERT_EQ(depth["methods"].size(), 3u);
    const Quantised hip(depth["hip"]);
    ASSERT_EQ(hip.values.size(), 3 * samples);
    for (const auto& method : depth["methods"]) {
      const Quantised force(method["force"]);
      ASSERT_EQ(force.values.size(), 3 * samples);
      std::size_t point = 0;
      for (std::size_t row = 0; row < table.rows(); ++row) {
        if (table["method"][row] != method["method"] ||
            table.number("depth", row) != depth["depth_m"].get<double>() * 1e3)
          continue;
        force.expect(3 * point + 1, table.number("fy", row));
        hip.expect(3 * point + 2, table.number("hip_z", row));
        ++point;
      }
      EXPECT_EQ(point, samples);
      float pairs = 0;
      for (const float count : floats(method["histograms"]["edge_step"])) pairs += count;
      EXPECT_EQ(pairs, method["statistics"]["edge_step"]["count"]);
      EXPECT_EQ(method["statistics"]["samples"], samples);
    }
  }
}

// The quickstart makes two sweeps such as these.
TEST_F(Report, PagesOfSweepsStaySmall) {
  for (const std::string depth : {"1mm", "2mm"})
    make("sweep", "ball.obj --depth " + depth + " --samples 1e5 --unit mm -o " + depth + ".h5");
  const auto results = results_of("1mm.h5 2mm.h5");
  EXPECT_GT(results[0]["depths"][0]["shown"], 50000);
  EXPECT_LE(folder_.read("page.html").size(), 6'000'000u);
}

TEST_F(Report, RunsTellTheSameByReportAndRecording) {
  make("run", "scene.toml --no-wait --seconds 2 --record run.h5 --summary run.json");
  make("run", "scene.toml --no-wait --seconds 2 --record run.csv");
  auto results = results_of("run.json run.h5 run.csv");
  const auto &figures = results[0]["figures"], &recorded = results[1]["figures"];
  EXPECT_EQ(results[0]["kind"], "run");
  EXPECT_EQ(results[1]["kind"], "recording");
  for (const char* key :
       {"ticks", "missed", "largest_force_step", "largest_sent_step", "largest_sent_force",
        "in_contact", "entries", "jumps_per_100k", "lost_per_100k", "sent_jumps_per_100k",
        "sent_lost_per_100k", "unsound", "success_rate"}) {
    EXPECT_EQ(figures[key], recorded[key]) << key;
    EXPECT_EQ(figures[key], results[2]["figures"][key]) << key;
  }
  EXPECT_EQ(figures["histograms"], recorded["histograms"]);
  EXPECT_GT(recorded["deepest_m"], 0);
  EXPECT_EQ(recorded["deepest_m"], results[2]["figures"]["deepest_m"]);
  const auto sent = floats(results[1]["sent"]);
  EXPECT_EQ(sent.size(), results[1]["shown"]);
  EXPECT_FLOAT_EQ(*std::max_element(sent.begin(), sent.end()),
                  figures["largest_sent_force"].get<float>());
}

// By these the page knows that they belong together.
TEST_F(Report, RunsSayTheirCommandSceneAndObjects) {
  const Outcome run =
      gliss("run", "scene.toml --no-wait --seconds 2 --record run.h5 --json --quiet");
  ASSERT_EQ(run.code, 0) << run.err;
  folder_.write("run.json", run.out);
  const auto results = results_of("run.json run.h5");
  EXPECT_EQ(results[0]["kind"], "run");
  EXPECT_EQ(results[1]["kind"], "recording");
  EXPECT_FALSE(results[0]["figures"].contains("histograms"));
  EXPECT_EQ(results[0]["origin"], results[1]["origin"]);
  const auto& origin = results[0]["origin"];
  EXPECT_THAT(origin["command_line"].get<std::string>(), HasSubstr("gliss run scene.toml"));
  EXPECT_EQ(origin["scene"], "scene.toml");
  EXPECT_TRUE(origin["objects"][0]["mesh"].is_string());
  EXPECT_GT(origin["objects"][0]["stiffness_N_per_m"], 0);

  auto wrong = nlohmann::json::parse(run.out);
  wrong["objects"][0]["stiffness_N_per_m"] = "soft";
  folder_.write("wrong.json", wrong.dump());
  expect_error(gliss("report", "wrong.json -o other.html"), 2,
               "wrong.json: 'objects' 0: 'stiffness_N_per_m' is not what gliss run writes");
}

TEST_F(Report, ComparisonsMayLackFigures) {
  folder_.write("compare.json", R"({"mesh": "a.obj", "faces": 7, "rows": [{"level": "full",
    "precision": "double", "solver": "newton", "backend": "tbb", "tick_us": 1.5,
    "max_force_error": null, "pareto": true}], "dense": [], "recommended": null})");
  const auto result = result_of("compare.json");
  EXPECT_EQ(result["kind"], "compare");
  EXPECT_EQ(result["origin"]["surface"], "a.obj");
  EXPECT_EQ(result["rows"][0]["tick_us"], 1.5);
  EXPECT_TRUE(result["rows"][0]["eval_per_s"].is_null());
  folder_.write("wrong.json", R"({"mesh": "a.obj", "rows": [{}, {"tick_us": "fast"}]})");
  expect_error(gliss("report", "wrong.json -o other.html"), 2,
               "wrong.json: 'rows' 1: 'tick_us' is not what gliss compare writes");
}

TEST_F(Report, ComparisonsShowSurfacesAndJumps) {
  save_obj(irregular(goldberg(), 1).mesh, folder_ / "triangles.obj");
  const Outcome compared =
      gliss("compare",
            "triangles.obj --unit mm --walks 20 --levels fair,exact,flat --precisions double "
            "--ticks 300 --dense-limit 0 --picture --json --quiet");
  ASSERT_EQ(compared.code, 0) << compared.err;
  folder_.write("compare.json", compared.out);
  const auto result = result_of("compare.json");
  ASSERT_EQ(result["picture"].size(), 2);
  const auto positions = floats(result["picture"][0]["position"]),
             curvatures = floats(result["picture"][0]["curvature"]),
             departures = floats(result["picture"][0]["departure"]);
  ASSERT_EQ(curvatures.size(), result["picture"][0]["points"]);
  ASSERT_EQ(departures.size(), result["picture"][0]["points"]);
  // The sag of the polygons, m.
  const float most = *std::max_element(departures.begin(), departures.end());
  EXPECT_GT(most, 1e-4);
  EXPECT_LT(most, 2e-3);
  for (std::size_t i = 0; i < curvatures.size(); ++i) {
    EXPECT_NEAR(std::hypot(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]), 10, 0.1);
    EXPECT_GT(curvatures[i], 95);  // 1/m: the ball's radius is 10 mm
  }
  EXPECT_NEAR(result["picture"][0]["p50_curvature"].get<double>(), 100, 10);
  const auto written = nlohmann::json::parse(compared.out);
  const auto steps = floats(result["rows"][2]["jumps"]["step"]);
  ASSERT_EQ(steps.size(), written["rows"][2]["jumps"].size());
  ASSERT_FALSE(steps.empty());
  EXPECT_FLOAT_EQ(steps[0], written["rows"][2]["jumps"][0]["step"].get<float>());

  const auto expect_refused_without = [&](const std::string& what, auto spoil) {
    nlohmann::json spoiled = written;
    spoil(spoiled);
    folder_.write("wrong.json", spoiled.dump());
    expect_error(gliss("report", "wrong.json -o other.html"), 2,
                 "wrong.json: " + what + " is not what gliss compare writes");
  };
  const auto text_of = [](nlohmann::json& json, const char* array) -> std::string& {
    return json["picture"][1][array]["f32"].get_ref<std::string&>();
  };
  expect_refused_without("'picture' 1: 'points'",
                         [](auto& json) { json["picture"][1].erase("points"); });
  expect_refused_without("'picture' 1: 'face'",
                         [](auto& json) { json["picture"][1]["points"] = 7; });
  expect_refused_without("'picture' 1: 'face'",
                         [](auto& json) { json["picture"][1]["points"] = 1e300; });
  expect_refused_without("'picture' 1: 'normal'",
                         [&](auto& json) { text_of(json, "normal").pop_back(); });
  expect_refused_without("'picture' 1: 'spot'",
                         [&](auto& json) { text_of(json, "spot")[5] = '<'; });
  expect_refused_without("'picture' 1: 'departure'",
                         [&](auto& json) { text_of(json, "departure").pop_back(); });
  expect_refused_without("'rows' 2: 'jumps' 0",
                         [](auto& json) { json["rows"][2]["jumps"][0]["step"] = "far"; });
  expect_refused_without("'rows' 2: 'jumps' 0",
                         [](auto& json) { json["rows"][2]["jumps"][0]["position"][1] = nullptr; });
  expect_refused_without("'rows' 2: 'jumps' 0",
                         [](auto& json) { json["rows"][2]["jumps"][0] = 3; });
}

// `points` a construction, all zero, and `jumps` a row.
nlohmann::json large_comparison(std::size_t points, std::size_t rows, std::size_t jumps) {
  const auto zeros = [&](const char* type, std::size_t numbers) {
    const std::size_t bytes = 4 * numbers * points, padding = (3 - bytes % 3) % 3;
    return nlohmann::json{
        {type, std::string((bytes + padding) / 3 * 4 - padding, 'A') + std::string(padding, '=')}};
  };
  nlohmann::json json = {
      {"mesh", "a.obj"}, {"rows", nlohmann::json::array()}, {"picture", nlohmann::json::array()}};
  for (const char* construction : {"fair", "paper"})
    json["picture"].push_back({{"construction", construction},
                               {"points", points},
                               {"face", zeros("u32", 1)},
                               {"position", zeros("f32", 3)},
                               {"normal", zeros("f32", 3)},
                               {"spot", zeros("f32", 1)},
                               {"curvature", zeros("f32", 1)}});
  for (std::size_t i = 0; i < rows; ++i) {
    nlohmann::json row = {
        {"level", "table"}, {"tick_us", 1.2345678901234}, {"jumps", nlohmann::json::array()}};
    for (std::size_t j = 0; j < jumps; ++j)
      row["jumps"].push_back(
          {{"position", {0.1, 0.2, 0.3}}, {"face", j}, {"step", 0.5}, {"lost", false}});
    json["rows"].push_back(row);
  }
  return json;
}

TEST_F(Report, PagesOfComparisonsStaySmall) {
  folder_.write("most.json", large_comparison(16000, 168, 200).dump());
  EXPECT_EQ(result_of("most.json")["picture"].size(), 2);
  EXPECT_LE(folder_.read("page.html").size(), 3'000'000u);
  folder_.write("more.json", large_comparison(200000, 1, 30000).dump());
  const auto more = result_of("more.json");
  EXPECT_EQ(more["picture"], true) << "is told, where it has no place";
  EXPECT_EQ(floats(more["rows"][0]["jumps"]["step"]).size(), 20000u);
  EXPECT_LE(folder_.read("page.html").size(), 3'000'000u);
}

TEST_F(Report, RefusesWhatItDoesNotKnow) {
  const std::string page_less = "is not a result of gliss trace, sweep, compare or run";
  folder_.write("empty.csv", "");
  expect_refused("empty.csv", "'empty.csv' " + page_less + ": it is empty");
  folder_.write("picture.png", "\x89PNG\r\n\x1a\nfx,fy");
  folder_.write("text.txt", "No result.");
  expect_refused("text.txt", "'text.txt' " + page_less);
  folder_.write("other.json", "{\"a\": 1}");
  expect_refused("other.json", "'other.json' " + page_less);
  folder_.write("cut.json", "{\"rows\": [");
  expect_refused("cut.json", "'cut.json' " + page_less + ": JSON that is damaged");
  folder_.write("run.json", R"({"histograms": {"wake": 3}})");
  expect_refused("run.json", "run.json: 'histograms/wake' is not a list");
  folder_.write("forces.csv", "step,fx\n1,2\n");
  expect_refused("forces.csv", "forces.csv:1: missing columns: wanted step,x,y,z");
  folder_.write("number.csv", std::string(kTraceHeader) + "1,flat,0,0,0,0,0,0,no,0,0,0,free\n");
  expect_refused("number.csv", "number.csv:2: column 'fx': 'no' is not a number");
  folder_.write("none.csv", kTraceHeader);
  expect_refused("none.csv", "none.csv: a trace without a tick");

  folder_.write("points.csv", "patch,xi,eta\n0,0,0\n");
  make("eval", "ball.obj --at points.csv --unit mm -o eval.h5");
  expect_refused("eval.h5", "'eval.h5' " + page_less);
  make("sweep", "ball.obj --depth 1mm --rings 2 --unit mm -o ball.h5");
  const std::string whole = folder_.read("ball.h5");
  folder_.write("cut.h5", whole.substr(0, whole.size() / 2));
  expect_refused("cut.h5", "cannot read 'cut.h5' as a result");

  expect_refused("missing.h5", "there is no file 'missing.h5'");
  expect_refused("ball.h5 missing.h5", "there is no file 'missing.h5'");
  expect_refused(".", "'.' is a folder");
  expect_error(gliss("report", "ball.h5 -o page.txt"), 2, "'page.txt' must end in .html");
  expect_error(gliss("report", "ball.h5"), 2, "--output is required");
}

TEST_F(Report, FailuresLeaveTheOldPage) {
  folder_.write("page.html", "old");
  folder_.write("text.txt", "No result.");
  expect_error(gliss("report", "text.txt -o page.html"), 2, "text.txt");
  EXPECT_EQ(folder_.read("page.html"), "old");
}

// Nothing that a file says of itself can end the script that holds it, or ask the network.
TEST_F(Report, PagesStandAlone) {
  folder_.write("a.json", R"({"mesh": "</script><script>alert(1)</script><!--", "rows": []})");
  const auto result = result_of("a.json");
  EXPECT_EQ(result["origin"]["surface"], "</script><script>alert(1)</script><!--");
  const std::string page = folder_.read("page.html");
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_EQ(page.find("alert(1)</script>"), page.npos);
  EXPECT_EQ(page.find("<script src"), page.npos);
  EXPECT_EQ(page.find("<link"), page.npos);
  EXPECT_THAT(page, EndsWith("</html>\n"));
}

TEST_F(Report, TellsWhatItDidAsJson) {
  folder_.write("a.json", R"({"mesh": "a", "rows": []})");
  const auto json = json_of(gliss("report", "a.json -o page.html --json"));
  EXPECT_EQ(json["page"], "page.html");
  EXPECT_EQ(json["bytes"], folder_.read("page.html").size());
  EXPECT_EQ(json["results"][0]["kind"], "compare");
}

#ifndef GLISS_WITH_REPORT
TEST(ReportLess, SaysHowToGetOne) {
  const test::ScratchFolder folder;
  folder.write("a.json", "{}");
  const Outcome outcome =
      test::Process(folder / "", test::kProgram, {"report", "a.json", "-o", "page.html"}).wait();
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("this build has no report"), HasSubstr("npm")));
}
#endif

}  // namespace
}  // namespace gliss
