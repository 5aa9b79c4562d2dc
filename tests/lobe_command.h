// Commands as their callers use them: exit status and what they print.
#pragma once

#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdio>
#include <string>

#include "folder.h"

namespace lobe::test {

struct Ended {
  int status = 0;
  std::string out, err;
};

// Runs a line of the shell in the folder.
inline Ended run_in(const Folder& folder, const std::string& line) {
  const std::string command = "cd '" + folder.path.string() + "' && " + line + " 2>messages.txt";
  FILE* pipe = popen(command.c_str(), "r");
  REQUIRE(pipe != nullptr);
  Ended ended;
  char buffer[4096];
  for (std::size_t n = 0; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) ended.out.append(buffer, n);
  const int status = pclose(pipe);
  ended.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  ended.err = bytes_of(folder.path / "messages.txt");
  return ended;
}

// Runs `lobe arguments`.
inline Ended lobe_in(const Folder& folder, const std::string& arguments,
                     const std::string& environment = "") {
  return run_in(folder, environment + " '" LOBE_BIN_DIR "/lobe' " + arguments);
}

}  // namespace lobe::test
