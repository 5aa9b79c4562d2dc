// What `--record` writes: a recording of each session of a run. The first one is of the scene that the
// program was given. Each "Simulate this", and each scene that is opened, begins another. Its scene and mesh
// are written beside it, so that `lobe replay` can play it:
//
//   drag.lobe                               of the scene of the command line
//   drag.2.lobe, drag.2.json, drag.2.vtu    of the first one that was painted or opened
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "live.h"

namespace lobe::view {

class Recordings {
 public:
  // `file`: empty, nothing is recorded.
  explicit Recordings(const std::filesystem::path& file) : file_(file) {}

  struct Written {
    std::filesystem::path scene, recording;
  };
  // A session has ended, and is written; `scene` and `mesh` are its own. Throws InputError if the files
  // cannot be written. The session is then kept, and written at the end.
  void ended(std::shared_ptr<Live> live, const Scene& scene, const TetMesh& mesh);
  // The present session as well: the last call. Whatever cannot be written, the others are. The first error
  // is thrown at the end.
  void end(std::shared_ptr<Live> live, const Scene& scene, const TetMesh& mesh);
  const std::vector<Written>& written() const { return written_; }

 private:
  struct Part {
    int number = 0;
    std::shared_ptr<Live> live;
    Scene scene;
    TetMesh mesh;
  };
  void write(const Part& part);

  const std::filesystem::path file_;
  int sessions_ = 0;
  std::vector<Part> unwritten_;
  std::vector<Written> written_;
};

}  // namespace lobe::view
