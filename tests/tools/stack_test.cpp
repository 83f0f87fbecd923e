// SPDX-License-Identifier: GPL-3.0-or-later
// The bound of the stack must cover every chain of calls, and be refused if a call cannot be followed.
#include <gtest/gtest.h>

#include "support/places.hpp"
#include "tools/scratch_tree.hpp"

namespace triskin::tests {
namespace {

constexpr const char* kPriorities = "constexpr int kLines = 0x40;\nconstexpr int kCan = 0x80;\n";

class Stack : public ScratchTree {
 protected:
  void SetUp() override {
    ScratchTree::SetUp();
    if (std::system("arm-none-eabi-g++ --version > /dev/null 2>&1") != 0)
      GTEST_SKIP() << "no cross compiler: install gcc-arm-none-eabi";
    write("priorities.hpp", kPriorities);
  }
  /// Compiles and links `code` and bounds its stack of 256 bytes.
  Ran bound(const std::string& code) {
    write("image.cpp", "extern \"C\" void hole(void*);\n#define NEVER_INLINE [[gnu::noinline, gnu::noipa]]\n" + code);
    const std::string compiler =
        "arm-none-eabi-g++ -mcpu=cortex-m4 -mthumb -Os -fno-exceptions -fno-rtti -fno-stack-protector "
        "-g1 -nostdlib -Wl,-e,reset_handler -Wl,--defsym,triskin_stack_bottom=0x20000000 "
        "-Wl,--defsym,triskin_stack_top=0x20000100 -o image.elf image.cpp";
    const Ran built = run("cd " + root_.string() + " && " + compiler + " 2>&1");
    EXPECT_EQ(built.exit_status, 0) << built.output;
    return run("cd " + root_.string() + " && python3 " + test::source_folder() +
               "/tools/check_stack.py arm-none-eabi-objdump arm-none-eabi-addr2line image.elf priorities.hpp "
               "image.stack 2>&1");
  }
};

// By hand: `deep` needs 64 bytes, LR and a word that aligns the stack; `shallow` needs 32 and as much; reset_handler
// two words. The handlers need only what the processor pushes, 104 + 4 bytes.
constexpr const char* kTwoLevels =
    "NEVER_INLINE void deep() { char a[64]; hole(a); }\nNEVER_INLINE void shallow() { char a[32]; hole(a); }\n"
    "extern \"C\" {\nNEVER_INLINE void hole(void*) { asm volatile(\"\"); }\n"
    "void reset_handler() { shallow(); deep(); asm volatile(\"\"); }\n%s}\n";

TEST_F(Stack, is_the_deepest_chain_of_calls) {
  std::string code = kTwoLevels;
  const Ran ran = bound(code.replace(code.find("%s"), 2, ""));
  EXPECT_EQ(ran.exit_status, 0) << ran.output;
  EXPECT_NE(ran.output.find("stack at most 80 of 256 bytes"), std::string::npos) << ran.output;
}

TEST_F(Stack, holds_a_handler_of_each_priority_and_no_two_of_one) {
  std::string code = kTwoLevels;
  const Ran ran = bound(code.replace(code.find("%s"), 2,
                                     "[[gnu::used]] void i2c1_event_handler() { asm volatile(\"\"); }\n"
                                     "[[gnu::used]] void i2c2_event_handler() { asm volatile(\"\"); }\n"
                                     "[[gnu::used]] void can_handler() { asm volatile(\"\"); }\n"));
  EXPECT_EQ(ran.exit_status, 1) << "80 and twice 108 are more than 256";
  EXPECT_NE(ran.output.find("stack at most 296 of 256 bytes"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("the stack may overflow"), std::string::npos) << ran.output;
}

TEST_F(Stack, follows_a_virtual_call_into_every_class) {
  const Ran ran = bound(
      "struct Port { virtual void other() = 0; virtual void send() = 0; };\n"
      "struct A final : Port { void other() override { asm volatile(\"\"); } void send() override { char a[16]; "
      "hole(a); } };\n"
      "struct B final : Port { void other() override { char a[128]; hole(a); } void send() override { char a[96]; "
      "hole(a); } };\n"
      "A a; B b; Port* volatile port = &a; Port* volatile second = &b;\n"
      "extern \"C\" {\nNEVER_INLINE void hole(void*) { asm volatile(\"\"); }\n"
      "void __cxa_pure_virtual() {}\n"
      "void reset_handler() { port->send(); asm volatile(\"\"); }\n}\n");
  EXPECT_EQ(ran.exit_status, 0) << ran.output;
  EXPECT_NE(ran.output.find("stack at most 112 of 256 bytes"), std::string::npos) << ran.output;
}

TEST_F(Stack, refuses_a_recursion) {
  const Ran ran = bound(
      "extern \"C\" {\nNEVER_INLINE void hole(void*) { asm volatile(\"\"); }\n"
      "NEVER_INLINE int sum(int n) { char a[8]; hole(a); return n == 0 ? 0 : sum(n - 1) + a[n & 7]; }\n"
      "void reset_handler() { volatile int n = 4; n = sum(n); }\n}\n");
  EXPECT_EQ(ran.exit_status, 1);
  EXPECT_NE(ran.output.find("the stack has no bound: recursion"), std::string::npos) << ran.output;
}

TEST_F(Stack, refuses_a_call_that_it_cannot_follow) {
  const Ran ran =
      bound("void (*volatile todo)();\nextern \"C\" void reset_handler() { todo(); asm volatile(\"\"); }\n");
  EXPECT_EQ(ran.exit_status, 1);
  EXPECT_NE(ran.output.find("is not known"), std::string::npos) << ran.output;
}

// `todo` is called in a place that has a rule, but the rule does not name its target.
TEST_F(Stack, refuses_a_function_that_no_rule_leads_to) {
  const Ran ran = bound(
      "NEVER_INLINE void secret() { asm volatile(\"\"); }\nvoid (*volatile todo)() = secret;\n"
      "extern \"C\" {\nNEVER_INLINE void start_up() { todo(); asm volatile(\"\"); }\n"
      "void reset_handler() { start_up(); asm volatile(\"\"); }\n}\n");
  EXPECT_EQ(ran.exit_status, 1);
  EXPECT_NE(ran.output.find("no rule of POINTERS"), std::string::npos) << ran.output;
}

TEST_F(Stack, refuses_a_frame_without_a_fixed_size) {
  const Ran ran = bound(
      "extern \"C\" {\nNEVER_INLINE void hole(void*) { asm volatile(\"\"); }\n"
      "void reset_handler() { volatile unsigned n = 9; hole(__builtin_alloca(n)); asm volatile(\"\"); }\n}\n");
  EXPECT_EQ(ran.exit_status, 1);
  EXPECT_NE(ran.output.find("no fixed size"), std::string::npos) << ran.output;
}

}  // namespace
}  // namespace triskin::tests
