// SPDX-License-Identifier: GPL-3.0-or-later
// triskin-cad: reads one CAD file with OpenCASCADE for the program `triskin`, or writes one (`write-step`). `triskin`
// starts it with limits of time and memory. The file, or the bodies to write, is standard input (a regular file), the
// answer is frames on standard output (triskin/cad/part_stream.hpp). It is no program for people: `triskin faces` is.
#include <fcntl.h>
#include <unistd.h>

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <new>
#include <string>

#include "document.hpp"
#include "part_builder.hpp"
#include "step_writer.hpp"
#include "triskin/cad/part_stream.hpp"
#include "triskin/cad/reader_sandbox.hpp"
#include "triskin/cad/write_step.hpp"

namespace {

using namespace triskin;

constexpr const char* kInput = "/proc/self/fd/0";

class FrameWriter {
 public:
  // The kernel prints to standard output, so that is redirected to nothing and frames use a copy of it.
  FrameWriter() : out_(::dup(STDOUT_FILENO)) {
    const int nothing = ::open("/dev/null", O_WRONLY);
    ::dup2(nothing, STDOUT_FILENO);
  }
  void write(cad::FrameKind kind, const std::string& payload) const {
    const std::string bytes = cad::frame(kind, payload);
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t n = ::write(out_, bytes.data() + at, bytes.size() - at);
      if (n <= 0) std::_Exit(EXIT_FAILURE);  // The reader of the pipe has ended.
      at += static_cast<std::size_t>(n);
    }
  }

 private:
  int out_;
};

std::string written_step(const FrameWriter& frames) {
  std::ifstream in(kInput, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  return cad_reader::step_of(cad::bodies_of(bytes),
                             [&](const std::string& what) { frames.write(cad::FrameKind::kStage, what); });
}

std::string answer(int count, char** arguments, const FrameWriter& frames) {
  if (count == 2) return written_step(frames);
  const std::string format = arguments[1];
  const cad_reader::BuildOptions options{std::strtod(arguments[2], nullptr), std::strtod(arguments[3], nullptr)};
  const auto stage = [&](const std::string& what) { frames.write(cad::FrameKind::kStage, what); };
  cad_reader::Document document;
  if (format == "iges") {
    document = cad_reader::read_iges(kInput, stage);
  } else {
    std::ifstream text(kInput, std::ios::binary);
    document = cad_reader::read_step(text, stage);
  }
  return cad::encode_part(cad_reader::build_part(document, options, stage));
}

}  // namespace

int main(int count, char** arguments) {
  const bool is_writer = count == 2 && std::strcmp(arguments[1], "write-step") == 0;
  if (count != 4 && !is_writer) {
    constexpr std::string_view kUsage = "triskin-cad is started by triskin; see triskin faces --help\n";
    (void)!::write(STDERR_FILENO, kUsage.data(), kUsage.size());
    return EXIT_FAILURE;
  }
  const FrameWriter frames;
  Message::DefaultMessenger()->ChangePrinters().Clear();
  // What is written comes from triskin itself, and OpenCASCADE needs a file for it. `triskin doctor` says where there
  // is no sandbox.
  if (!is_writer) (void)cad::enter_reader_sandbox();
  try {
    frames.write(cad::FrameKind::kPart, answer(count, arguments, frames));
  } catch (const std::bad_alloc&) {
    frames.write(cad::FrameKind::kError, "it needs more memory than it may take");
  } catch (const std::exception& e) {
    frames.write(cad::FrameKind::kError, e.what());
  } catch (const Standard_Failure& e) {
    frames.write(cad::FrameKind::kError, std::string("the geometry kernel gives up: ") + e.DynamicType()->Name());
  }
  // Destructors of the kernel's objects may crash, and the answer is already sent.
  std::_Exit(EXIT_SUCCESS);
}
