// SPDX-License-Identifier: GPL-3.0-or-later
// A fault in a scene is reported with its file, its path in the file (or the line of text that is not JSON) and the
// remedy.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "scene_case.hpp"

namespace triskin::hardware {
namespace {

using testing::HasSubstr;

class BadScenes : public SceneCase, public testing::WithParamInterface<BadScene> {};

TEST_P(BadScenes, are_refused_with_file_path_and_remedy) {
  const std::string head = "{\"format\":\"triskin-scene\",\"version\":1,\n\"design\":\"d.json\",\n";
  const std::string error = error_of(head + GetParam().line + "\n}\n");
  EXPECT_THAT(error, testing::AnyOf(HasSubstr("s.json: /"), HasSubstr("s.json: top level: "),
                                    HasSubstr("s.json: is not JSON: line 3")));
  EXPECT_THAT(error, HasSubstr(GetParam().remedy));
}

constexpr BadScene kKeysAndTypes[] = {
    {R"("fault":[])", "key \"fault\" is unknown"},
    {R"("seed":1,"seed":2)", "\"seed\" appears twice"},
    {R"("seed":-1)", "not negative"},
    {R"("seed":"one")", "whole number"},
    {R"("seed":NaN)", "is not JSON: line 3, column 8"},
    {R"("effects":{"noise_counts":1e999})", "out of range"},
    {R"("converters":"real")", "must be \"drawn\", \"ideal\" or an object with properties"},
    {R"("converters":{"zero":1})", "is no property of a converter"},
    {R"("converters":{"zero_counts":6000})", "/converters/zero_counts"},
    {R"("converters":{"others":"some"})", "must be \"drawn\" or \"ideal\""},
    {R"("contacts":{})", "must be an array"},
    {R"("contacts":[7])", "must be an object"},
    {R"("contacts":[{"module":1,"force":1}])", "key \"force\" is unknown"},
    {R"("contacts":[{"module":1,"force_n":"2 N"}])", "must be a number"},
    {R"("contacts":[{"module":1,"force_n":null}])", "must be a number"},
    {R"("contacts":[{"module":1,"at_ms":500}])", "key \"at_ms\" is unknown"},
    {R"("contacts":[{"module":"4"}])", "must be an integer"},
    {R"("hardware":"soft")", "\"strapped\" or \"switched\""},
    {R"("border_joints":true)", "needs \"hardware\": \"switched\""},
    {R"("contacts":[{"module":1},])", "is not JSON: line 3, column 26"},
};
INSTANTIATE_TEST_SUITE_P(KeysAndTypes, BadScenes, testing::ValuesIn(kKeysAndTypes));

constexpr BadScene kPlaces[] = {
    {R"("contacts":[{}])", "needs either"},
    {R"("contacts":[{"module":1,"ray":{"from_mm":[0,0,9],"direction":[0,0,-1]}}])", "one of them says where"},
    {R"("contacts":[{"module":6}])", "must be in 0 … 5"},
    {R"("contacts":[{"module":1,"taxel":12}])", "must be in 0 … 11"},
    {R"("contacts":[{"module":1,"taxel":6}])", "choose another taxel"},
    {R"("contacts":[{"position_mm":[1,2,3],"taxel":1}])", "needs \"module\""},
    {R"("contacts":[{"position_mm":[1,2]}])", "must have 3 elements"},
    {R"("contacts":[{"nearest_to_mm":[0,0,1e9]}])", "nearest_to_mm/2: must be in"},
    {R"("contacts":[{"ray":{"from_mm":[15,9,50]}}])", "\"direction\" is missing"},
    {R"("contacts":[{"ray":{"from_mm":[15,9,50],"direction":[0,0,0]}}])", "give a vector"},
    {R"("contacts":[{"ray":{"from_mm":[15,9,50],"direction":[0,0,1]}}])", "passes by the skin"},
    {R"("contacts":[{"position_mm":[15,9,500]}])", "the nearest is 500.0 mm away"},
    {R"("contacts":[{"module":1,"radius_mm":0}])", "radius_mm: must be in"},
    {R"("contacts":[{"module":1,"force_n":-1}])", "force_n: must be in"},
};
INSTANTIATE_TEST_SUITE_P(Places, BadScenes, testing::ValuesIn(kPlaces));

constexpr BadScene kTimes[] = {
    {R"("contacts":[{"module":1,"at_s":2,"until_s":1}])", "must be later than \"at_s\""},
    {R"("contacts":[{"module":1,"at_s":-1}])", "at_s: must be in"},
    {R"("contacts":[{"module":1,"to":{"module":2}}])", "needs \"until_s\""},
    {R"("contacts":[{"module":1,"until_s":2,"to":{"module":2},"to_mm":[1,2,3]}])", "leave one out"},
    {R"("contacts":[{"module":1,"until_s":1,"rise_s":0.7,"fall_s":0.7}])", "longer than the contact lasts"},
    {R"("contacts":[{"module":1,"fall_s":0.7}])", "needs \"until_s\""},
    {R"("contacts":[{"module":1,"every_s":1}])", "the end of the first pass"},
    {R"("contacts":[{"module":1,"until_s":2,"every_s":1}])", "must be at least 2"},
    {R"("contacts":[{"module":1,"until_s":2,"passes":3}])", "needs \"every_s\""},
    {R"("contacts":[{"module":1,"until_s":2,"every_s":3,"passes":0}])", "passes: must be in"},
    {R"("contacts":[{"keyframes":[]}])", "must have 1 …"},
    {R"("contacts":[{"keyframes":[{"at_s":1}]}])", "needs a place"},
    {R"("contacts":[{"module":1,"keyframes":[{"force_n":1}]}])", "\"at_s\" is missing"},
    {R"("contacts":[{"module":1,"keyframes":[{"at_s":2},{"at_s":1}]}])", "sort them by time"},
    {R"("contacts":[{"module":1,"at_s":1,"keyframes":[{"at_s":2}]}])", "leave it out"},
    {R"("contacts":[{"module":1,"until_s":1,"keyframes":[{"at_s":0},{"at_s":2}]}])", "earlier than the last keyframe"},
    {R"("contacts":[{"module":1,"on_skin":true}])", "does not move"},
    {R"("pressure":[{"at_s":2,"kpa":1},{"at_s":1,"kpa":1}])", "earlier than the point before"},
};
INSTANTIATE_TEST_SUITE_P(Times, BadScenes, testing::ValuesIn(kTimes));

constexpr BadScene kFaults[] = {
    {R"("faults":[{"kind":"melted"}])", "is not a kind of fault"},
    {R"("faults":[{"kind":"removed_chip"}])", "\"module\" is missing"},
    {R"("faults":[{"kind":"removed_chip","module":1,"line":2}])", "unknown for a removed_chip"},
    {R"("faults":[{"kind":"removed_chip","module":1,"at_s":2,"until_s":2}])", "must be later"},
    {R"("faults":[{"kind":"open_line","module":1}])", "\"line\" is missing"},
    {R"("faults":[{"kind":"loose_plug","module":1,"line":2}])", "unknown for a loose_plug"},
    {R"("faults":[{"kind":"drifting_chip","module":1}])", "\"counts_per_s\" is missing"},
    {R"("faults":[{"kind":"other_firmware","patch":0,"wire_version":70000}])", "wire_version"},
    {R"("faults":[{"kind":"same_number","patch":0,"other":0}])", "must be another patch"},
    {R"("faults":[{"kind":"swapped_chips","module":1,"other":1}])", "must be another module"},
    {R"("faults":[{"kind":"stuck_line","patch":1,"line":0}])", "patch: must be in 0 … 0"},
    {R"("faults":[{"kind":"stuck_line","patch":0,"line":0,"signal":"x"}])", "\"sda\" or \"scl\""},
    {R"("faults":[{"kind":"lost_configuration","module":1,"until_s":3}])", "or give \"every_s\""},
    {R"("faults":[{"kind":"dead_module","module":1}])", "needs \"hardware\": \"switched\""},
    {R"("hardware":"switched","faults":[{"kind":"moved_chip","module":1,"line":0,"address":0}])",
     "is a fault of straps"},
    {R"("hardware":"switched","faults":[{"kind":"open_joint","module":1,"other":5}])", "has no joint"},
    {R"("hardware":"switched","faults":[{"kind":"rotated_module","module":1,"at_s":2}])", "joined before power comes"},
    {R"("hardware":"switched","faults":[{"kind":"module_reset","module":1,"until_s":2}])", "takes no time"},
    {R"("effects":{"clock_ppm":[1,2]})", "the design has 1 controllers"},
};
INSTANTIATE_TEST_SUITE_P(Faults, BadScenes, testing::ValuesIn(kFaults));

constexpr BadScene kControllers[] = {
    {R"("controllers":[{"patch":0}])", "\"level\" is missing"},
    {R"("controllers":[{"level":"fast"}])", "give firmware or table"},
    {R"("controllers":[{"patch":1,"level":"table"}])", "patch: must be in 0 … 0"},
    {R"("controllers":[{"part":"arm","level":"table"}])", "belongs to the scene of a robot"},
    {R"("hardware":"switched","controllers":[{"level":"table"}])", "must be \"firmware\", which routes them"},
    {R"("controllers":[{"level":"table"}],"effects":{"clock_ppm":[20]})", "controller 0 is simulated by its table"},
};
INSTANTIATE_TEST_SUITE_P(Controllers, BadScenes, testing::ValuesIn(kControllers));

constexpr BadScene kExpectations[] = {
    {R"("expect":[{"module":1,"pressed":true}])", "\"at_s\" is missing"},
    {R"("expect":[{"at_s":1,"module":1}])", "must say one thing"},
    {R"("expect":[{"at_s":1,"module":1,"pressed":true,"more_than_n":1}])", "must say one thing"},
    {R"("expect":[{"at_s":1,"module":9,"pressed":true}])", "must be in 0 … 5"},
    {R"("expect":[{"at_s":1,"taxel":3,"pressed":true}])", "needs \"module\""},
    {R"("expect":[{"at_s":1,"module":1,"pressed":1}])", "must be true or false"},
    {R"("expect":[{"at_s":1,"module":1,"state":"tired"}])", "give unknown, ok, absent"},
    {R"("expect":[{"at_s":1,"state":"ok"}])", "needs \"module\""},
    {R"("expect":[{"at_s":1,"module":1,"silent":true}])", "how long nothing is to come"},
    {R"("expect":[{"at_s":1,"module":1,"once":true,"pressed":true}])", "needs \"until_s\""},
    {R"("expect":[{"at_s":2,"until_s":1,"module":1,"pressed":true}])", "must be later"},
};
INSTANTIATE_TEST_SUITE_P(Expectations, BadScenes, testing::ValuesIn(kExpectations));

}  // namespace
}  // namespace triskin::hardware
