// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "support/temp_folder.hpp"
#include "triskin/base/files.hpp"
#include "triskin/base/require_file.hpp"
#include "triskin/base/xml_depth.hpp"

namespace triskin {
namespace {

using testing::HasSubstr;

std::string nested(int depth, const std::string& inside = "") {
  std::string text;
  for (int k = 0; k < depth; ++k) text += "<g>";
  text += inside;
  for (int k = 0; k < depth; ++k) text += "</g>";
  return text;
}

TEST(XmlDepth, elements_may_be_nested_as_deep_as_the_bound) {
  EXPECT_NO_THROW(require_shallow_xml(nested(kMaxXmlDepth), "a.svg"));
  EXPECT_INPUT_ERROR(require_shallow_xml("<?xml version=\"1.0\"?>\n" + nested(kMaxXmlDepth + 1), "a.svg"),
                     "a.svg, line 2: its XML is nested more than 500 deep");
}

// None of these opens or closes an element: a comment, characters, a value with ">", empty elements, entities.
TEST(XmlDepth, only_tags_count) {
  for (const char* inside : {"<!-- <a> -->", "<![CDATA[<a>]]>", "<a b=\"/>\" c='<a>'></a>",
                             "<a/><a b=\"x\" /><?p <a>?>", "<!DOCTYPE svg [<!ENTITY a \"<a>\">]>"}) {
    EXPECT_NO_THROW(require_shallow_xml(nested(kMaxXmlDepth - 1, inside), "a.svg")) << inside;
  }
}

// An end tag in what is no element must not make room for others.
TEST(XmlDepth, hidden_end_tags_do_not_count) {
  for (const char* hidden :
       {"<!-- </g> -->", "<![CDATA[</g>]]>", "<a b=\"</g>\"/>", "<!DOCTYPE svg [</g>]>", "<? </g> ?>"})
    EXPECT_INPUT_ERROR(require_shallow_xml(nested(kMaxXmlDepth, hidden + std::string("<g></g>")), "a.svg"), "nested");
}

TEST(XmlDepth, cut_texts_end) {
  for (const char* text : {"<", "<a b=\"", "<!--", "<![CDATA[", "<!DOCTYPE [", "<?", "</", "<a/"})
    EXPECT_NO_THROW(require_shallow_xml(text, "a.svg")) << text;
}

TEST(RequireFile, what_may_never_end_is_refused) {
  test::TempFolder folder;
  const auto pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_INPUT_ERROR(require_file(pipe, Pipes::kRefused), "is a pipe; give a file");
  EXPECT_NO_THROW(require_file(pipe, Pipes::kAllowed));
  EXPECT_INPUT_ERROR((void)read_file("/dev/zero"), "/dev/zero: is a device or socket; give a file");
  EXPECT_INPUT_ERROR((void)read_file("/tmp"), "/tmp: is a folder; give a file");
  EXPECT_NO_THROW(require_file(folder / "none", Pipes::kRefused));
}

}  // namespace
}  // namespace triskin
