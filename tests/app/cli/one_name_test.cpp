// SPDX-License-Identifier: GPL-3.0-or-later
// Reads one module, and its controller, in all outputs of a design and of a robot, and compares what they say.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>

#include "app/cli/shell_case.hpp"
#include "support/strip_design.hpp"

namespace triskin::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// Module 21 of a strip of 40 is on its second controller, so that module, row, patch and address are all different. In
// a strip with gaps it has number 28.
constexpr int kModules = 40, kId = 21;

class OneName : public ShellCase, public testing::WithParamInterface<bool> {
 protected:
  void SetUp() override {
    ShellCase::SetUp();
    design::write_design(folder_ / "strip.json", GetParam() ? with_gaps(strip(kModules)) : strip(kModules));
    design_ = json::parse(read_file(folder_ / "strip.json"));
    module_ = design_["modules"][kId];
    ASSERT_EQ(module_["id"], number_);
    patch_ = module_["patch"];
    const int address = module_["address"];
    strap_ = fmt::format("ADD0{} ADD1{} ({:02X})", (address & 1) != 0 ? 'H' : 'L', (address & 2) != 0 ? 'H' : 'L',
                         0x2C + address);
    ASSERT_GT(patch_, 0);
  }

  void write(const char* file, const json& content) { std::ofstream(folder_ / file) << content; }
  [[nodiscard]] json page_model(const std::string& file) const {
    const std::string page = read_file(folder_ / file), begin = "id=\"model\">";
    const auto from = page.find(begin) + begin.size();
    return json::parse(page.substr(from, page.find("</script>", from) - from));
  }
  [[nodiscard]] json finding_of(const std::string& report) const {
    const json findings = json::parse(read_file(folder_ / report))["findings"];
    EXPECT_EQ(findings.size(), 1U) << findings.dump(1);
    return findings.at(0);
  }

  // What Debian's Python says, with the module of this build where it was built; nothing if it lacks what the code
  // imports.
  [[nodiscard]] std::string python(const std::string& code) {
    std::ofstream(folder_ / "asked.py") << code;
    const auto modules = std::filesystem::path(program_file()).parent_path().parent_path() / "python";
    const std::string command =
        fmt::format("cd '{}' && PYTHONPATH='{}' XDG_STATE_HOME=state /usr/bin/python3 asked.py >out 2>messages",
                    folder_.string(), modules.string());
    const bool is_done = std::system(command.c_str()) == 0;
    const std::string messages = read_file(folder_ / "messages");
    if (is_done) return read_file(folder_ / "out");
    EXPECT_THAT(messages, HasSubstr("ModuleNotFoundError")) << code;
    return {};
  }

  json design_, module_;
  const int number_ = GetParam() ? 28 : 21;
  int patch_ = 0;
  std::string strap_;
};

TEST_P(OneName, of_a_module_in_all_outputs_of_a_design) {
  std::map<std::string, std::string> said;  // by output
  const std::string expected =
      fmt::format("module {} patch {} L{} {}", number_, patch_, module_["line"].get<int>(), strap_);
  const auto as_text = [&](int module, int patch, int line, int address) {
    return fmt::format("module {} patch {} L{} ADD0{} ADD1{} ({:02X})", module, patch, line, "LH"[address & 1],
                       "LH"[address >> 1 & 1], 0x2C + address);
  };

  ASSERT_EQ(run("export strip.json -o taxels.csv").status, 0);
  std::istringstream csv(read_file(folder_ / "taxels.csv"));
  for (std::string row; std::getline(csv, row);) {
    int module = 0, taxel = 0, patch = 0, line = 0, address = 0;
    if (std::sscanf(row.c_str(), "strip,%d,%d,%d,%d,%d", &module, &taxel, &patch, &line, &address) == 5 &&
        module == number_)
      said["taxels.csv"] = as_text(module, patch, line, address);
  }

  ASSERT_EQ(run("export strip.json -o page.html").status, 0);
  const json shown = page_model("page.html")["modules"][kId];
  said["page"] = as_text(shown["number"], shown["patch"], shown["line"], shown["address"]);

  // A sheet of a strip in SVG has outlines for text, so its words are read from the plan in tests/output/sheet.
  write("scene.json", {{"format", "triskin-scene"},
                       {"version", 1},
                       {"design", "strip.json"},
                       {"faults", {{{"kind", "removed_chip"}, {"module", number_}}}}});
  ASSERT_EQ(run("flash strip.json --link sim").status, 0);
  const Outcome verified = run("verify strip.json --link sim --scene scene.json --report report.json");
  EXPECT_EQ(verified.status, 1);
  const std::regex place(R"(module (\d+) \(patch (\d+), (L\d), (ADD0. ADD1. \(\w\w\))\))");
  std::smatch m;
  ASSERT_TRUE(std::regex_search(verified.out, m, place)) << verified.out;
  said["finding on the terminal"] = fmt::format("module {} patch {} {} {}", m.str(1), m.str(2), m.str(3), m.str(4));
  const json finding = finding_of("report.json");
  EXPECT_EQ(finding["module"], number_);
  EXPECT_EQ(finding["patch"], patch_);
  const std::string text = finding.dump();
  ASSERT_TRUE(std::regex_search(text, m, place)) << text;
  said["finding in the report"] = fmt::format("module {} patch {} {} {}", m.str(1), m.str(2), m.str(3), m.str(4));

  const Outcome live = run(fmt::format("live strip.json --link sim --seconds 0.6 --press {} --json", number_));
  std::istringstream objects(live.out);
  int pressed = 0;
  for (std::string object; std::getline(objects, object);) {
    const json line = json::parse(object);
    for (const json& taxel : line["pressed"]) {
      EXPECT_EQ(taxel["module"], number_);
      ++pressed;
    }
  }
  EXPECT_GT(pressed, 0) << live.out;
  ASSERT_EQ(run("record strip.json --link sim --seconds 0.2 -o samples.csv").status, 0);
  EXPECT_THAT(read_file(folder_ / "samples.csv"), testing::ContainsRegex(fmt::format("(^|\n|,){},", number_)));

  // The neighbours are those of the label, too.
  const Outcome played = run("record strip.json --link sim --seconds 0.2 -o samples.mcap");
  ASSERT_EQ(played.status, 0) << played.messages;
  ASSERT_EQ(run("replay samples.mcap --speed 0 --json").status, 0);
  EXPECT_EQ(run("flash strip.json --link sim --route backup:9999").status, 2);
  EXPECT_THAT(run("edit strip.json --remove 9999 -o x.json").messages, HasSubstr("there is no module 9999"));

  ASSERT_EQ(run("export samples.mcap --format html -o recorded.html").status, 0);
  const json recorded = page_model("recorded.html")["modules"][kId];
  said["page of the recording"] = as_text(recorded["number"], recorded["patch"], recorded["line"], recorded["address"]);

  std::string read =
      python(fmt::format("import triskin\nwith triskin.open('samples.mcap') as s:\n  k = list(s.numbers).index({})\n"
                         "  print(k, s.patches[k])\n",
                         number_));
  if (!read.empty()) {
    EXPECT_EQ(read, fmt::format("{} {}\n", kId, patch_));
  }
  if (run("export strip.json --format hdf5 -o taxels.h5").status == 0) {
    ASSERT_EQ(run("record strip.json --link sim --seconds 0.2 -o samples.h5").status, 0);
    read =
        python(fmt::format("import h5py\nf = h5py.File('taxels.h5')\nk = list(f['module'][:]).index({0})\n"
                           "print(f['cover'][k].decode(), *(f[c][k] for c in ('module', 'patch', 'line', 'address')))\n"
                           "g = h5py.File('samples.h5')\nk = list(g['module'][:]).index({0})\nprint(g['module'][k], "
                           "g['reader_patch'][k])\n",
                           number_));
    if (!read.empty()) {
      EXPECT_EQ(read, fmt::format("strip {0} {1} {2} {3}\n{0} {1}\n", number_, patch_, module_["line"].get<int>(),
                                  module_["address"].get<int>()));
    }
  }

  ASSERT_EQ(said.size(), 5U);
  for (const auto& [output, words] : said) {
    std::printf("%-24s %s\n", output.c_str(), words.c_str());
    EXPECT_EQ(words, expected) << output;
  }
}

std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// Two covers of the same design on one bus: of the second one, "upperarm", every number is that of its own design, and
// the node address that of the robot file.
TEST_P(OneName, of_a_module_and_a_controller_of_a_robot) {
  ASSERT_EQ(run("robot new robot.json --name demo --bus left=sim").status, 0);
  ASSERT_EQ(run("robot add robot.json strip.json --name forearm --bus left").status, 0);
  ASSERT_EQ(run("robot add robot.json strip.json --name upperarm --bus left --xyz-mm 0,0,300").status, 0);
  const json file = json::parse(read_file(folder_ / "robot.json"));
  const json& controllers = file["covers"][1]["controllers"];
  const int node = std::ranges::find(controllers, json(patch_), [](const json& c) { return c["patch"]; })->at("node");
  const int joint = kModules + kId;  // what nobody may read
  EXPECT_NE(node, patch_ + 1);
  write("scene.json", {{"format", "triskin-scene"},
                       {"version", 1},
                       {"robot", "robot.json"},
                       {"faults", {{{"part", "upperarm"}, {"kind", "removed_chip"}, {"module", number_}}}}});
  ASSERT_EQ(run("flash robot.json --link sim").status, 0);

  const std::string controller = fmt::format("patch {:3}  bus left  node address {:3}", patch_, node);
  const std::string show = run("robot show robot.json").out;
  EXPECT_THAT(show.substr(show.find("cover upperarm")), HasSubstr(controller));
  const Outcome found = run("discover robot.json --link sim");
  EXPECT_THAT(found.out, testing::ContainsRegex(fmt::format("node address {}  .*upperarm, patch {}\n", node, patch_)));

  const Outcome verified = run("verify robot.json --link sim --scene scene.json --report report.json");
  EXPECT_EQ(verified.status, 1);
  EXPECT_THAT(verified.out, HasSubstr(fmt::format("upperarm: absent_module: module {} (patch {}, L{}, {})", number_,
                                                  patch_, module_["line"].get<int>(), strap_)));
  EXPECT_THAT(verified.out, testing::Not(HasSubstr(fmt::format("module {}", joint))));
  const Outcome live = run("live robot.json --link sim --scene scene.json --seconds 0.6");
  EXPECT_THAT(live.out + live.messages, HasSubstr(fmt::format("upperarm: never heard: module {}", number_)));

  for (const char* command : {"export robot.json -o page.html", "export robot.json --switched -o page.html"}) {
    ASSERT_EQ(run(command).status, 0);
    const json model = page_model("page.html");
    EXPECT_EQ(model["covers"][1]["name"], "upperarm");
    EXPECT_EQ(model["covers"][1]["first_module"], kModules);
    const int first_patch = model["covers"][1]["first_patch"];
    EXPECT_EQ(model["modules"][joint]["patch"], first_patch + patch_);
    EXPECT_EQ(model["modules"][joint]["number"], number_);
    EXPECT_EQ(model["patches"][first_patch + patch_]["node"], node);
    EXPECT_EQ(model["modules"][joint]["address"], module_["address"]);
  }
  ASSERT_EQ(run("export robot.json -o taxels.csv").status, 0);
  const std::string rows = read_file(folder_ / "taxels.csv");
  EXPECT_EQ(count_of(rows, "\nforearm,"), 12U * kModules);
  EXPECT_EQ(count_of(rows, "\nupperarm,"), 12U * kModules);
  EXPECT_THAT(rows, HasSubstr(fmt::format("\nupperarm,{},0,{},{},{},", number_, patch_, module_["line"].get<int>(),
                                          module_["address"].get<int>())));
  const std::string name = fmt::format("upperarm_module_{}", number_), through = fmt::format("module_{}", joint);
  for (const char* format : {"urdf", "sdf", "gltf", "mjcf", "mjcf-touch", "taxel-list", "modules"}) {
    ASSERT_EQ(run(fmt::format("export robot.json --format {} -o x", format)).status, 0) << format;
    const std::string text = read_file(folder_ / "x");
    EXPECT_THAT(text, testing::ContainsRegex("[^a-z]((demo_)?" + name + ")[^0-9]")) << format;
    EXPECT_EQ(count_of(text, through + "\"") + count_of(text, through + " "), 0U) << format;
    EXPECT_EQ(count_of(text, "\"module\":" + std::to_string(joint) + ","), 0U) << format;
  }
  EXPECT_THAT(read_file(folder_ / "x"), HasSubstr(fmt::format("\ng {} upperarm_patch_{}\nf ", name, patch_)));
  ASSERT_EQ(run("export robot.json --format urdf -o x").status, 0);
  EXPECT_THAT(read_file(folder_ / "x"),
              HasSubstr(fmt::format("<triskin:taxel cover=\"upperarm\" module=\"{}\" index=\"0\"", number_)));
  ASSERT_EQ(run("export robot.json --format picture -o x.svg").status, 0);
  EXPECT_EQ(count_of(read_file(folder_ / "x.svg"), ">upperarm</text>"), std::size_t{kModules});
  EXPECT_EQ(run("export robot.json --format icub-positions -o icub.txt").out, "icub.forearm.txt\nicub.upperarm.txt\n");
  if (run("export robot.json --format hdf5 -o taxels.h5").status == 0) {
    const std::string read = python(
        fmt::format("import h5py\nf = h5py.File('taxels.h5')\n"
                    "k = [(c.decode(), m) for c, m in zip(f['cover'][:], f['module'][:])].index(('upperarm', {}))\n"
                    "print(k, *(f[c][k] for c in ('patch', 'line', 'address')))\n",
                    number_));
    if (!read.empty()) {
      EXPECT_EQ(read, fmt::format("{} {} {} {}\n", 12 * joint, patch_, module_["line"].get<int>(),
                                  module_["address"].get<int>()));
    }
  }
  const Outcome sheets = run("export robot.json -o sheet.pdf");
  if (sheets.messages.find("without its assembly sheet") != std::string::npos) return;
  EXPECT_EQ(sheets.out, "sheet.forearm.pdf\nsheet.upperarm.pdf\n") << sheets.messages;
}

// A number that no controller has belongs to no board, patch or place of a cable.
TEST_P(OneName, of_controllers_with_a_free_number) {
  for (const std::string hardware : {"", " --switched"}) {
    const std::string link = "strip.json --link sim" + hardware + " --json";
    EXPECT_EQ(json::parse(run("flash " + link).out)["controllers"], 3) << hardware;
    const Outcome verified = run("verify " + link + " --touch");
    EXPECT_EQ(verified.status, 0) << verified.out;
    EXPECT_EQ(json::parse(verified.out)["modules"], kModules);
  }
  const Outcome one = run("flash strip.json --link sim --patch 1");
  EXPECT_EQ(one.status, GetParam() ? 2 : 0);
  EXPECT_EQ(one.messages.find("--patch 1: the design has patches 0,2-3") != std::string::npos, GetParam());
}

// A box has modules on all of its sides, so one view does not show all of them; a strip is seen from one side.
TEST_P(OneName, each_module_of_a_picture_has_its_number) {
  ASSERT_EQ(run("export strip.json -o strip.svg").status, 0);
  const std::string strip_picture = read_file(folder_ / "strip.svg");
  EXPECT_EQ(count_of(strip_picture, "<g "), 1U);
  for (const json& module : design_["modules"])
    EXPECT_EQ(count_of(strip_picture, fmt::format(">{}</text>", module["id"].get<int>())), 1U) << module["id"];
  const std::string box = source_folder() + "/tests/output/view/designs/box.json";
  ASSERT_EQ(run("export '" + box + "' --format picture -o box.svg").status, 0);
  const std::string picture = read_file(folder_ / "box.svg");
  EXPECT_GE(count_of(picture, "<g "), 4U);
  for (std::size_t k = 0; k < json::parse(read_file(box))["modules"].size(); ++k)
    EXPECT_GE(count_of(picture, fmt::format(">{}</text>", k)), 1U) << k;
}

INSTANTIATE_TEST_SUITE_P(Numbers, OneName, testing::Bool(),
                         [](const auto& gaps) { return gaps.param ? "with_gaps" : "without_gaps"; });

}  // namespace
}  // namespace triskin::test
