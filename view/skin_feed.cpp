#include "skin_feed.h"

#include <utility>

#include "lobe/io/surface_io.h"

namespace lobe::view {

template <class Real>
SkinFeed<Real>::SkinFeed(const std::filesystem::path& file, const TetMesh& mesh, World<Real>& world)
    : skin_(read_obj(file), mesh), whole_(skin_), restored_(world.body().model.revisions.restored) {
  const Mat3X<Real> none = Mat3X<Real>::Zero(3, mesh.points.cols());
  skin_.update(mesh.points, none, rest_, normals_);
  show();
  world.on_cut([this, &world](const Topology& topology, const MeshEdit& edit) {
    if (!follow_restored(world)) skin_.follow(topology, edit, world.grains());
  });
}

template <class Real>
void SkinFeed<Real>::show() {
  const std::uint64_t revision = shown_ ? shown_->revision + 1 : 0;
  const std::vector<SkinMesh::Between>& between = skin_.mesh().between;  // vertices that blades have made
  const auto made = static_cast<Eigen::Index>(between.size()), first = skin_.mesh().vertex_count() - made;
  rest_.conservativeResize(3, first + made);
  for (Eigen::Index i = 0; i < made; ++i) {
    const SkinMesh::Between& own = between[std::size_t(i)];
    rest_.col(first + i) = (1 - own.share) * rest_.col(own.a) + own.share * rest_.col(own.b);
  }
  shown_ = std::make_shared<const ShownSkin>(ShownSkin{revision, skin_.mesh().triangles, rest_});
  skin_revision_ = skin_.mesh().revision;
}

// A world that was put back may be cut before the next picture.
template <class Real>
bool SkinFeed<Real>::follow_restored(const World<Real>& world) {
  const std::uint64_t restored = world.body().model.revisions.restored;
  if (std::exchange(restored_, restored) == restored) return false;
  skin_ = whole_;
  skin_.follow_all(world.elements().topology, world.grains());
  skin_revision_ = never;
  return true;
}

template <class Real>
void SkinFeed<Real>::update(World<Real>& world) {
  follow_restored(world);
  if (!is_wanted_) return;
  if (skin_revision_ != skin_.mesh().revision) show();
  Picture* picture = pictures_.writable();
  if (!picture) return;
  skin_.update(world.elements().points.view(), world.displacements(), picture->x, normals_);
  picture->shown = shown_;
  pictures_.publish();
}

template <class Real>
void SkinFeed<Real>::write(std::uint64_t first_stamp, std::uint64_t& told, BlockWriter& out) const {
  const auto picture = pictures_.latest();
  if (!picture || !picture->shown) return;
  const ShownSkin& shown = *picture->shown;
  if (const std::uint64_t stamp = first_stamp + shown.revision + 1; std::exchange(told, stamp) != stamp)
    write_skin(shown.revision, shown.triangles, shown.rest, out);
  write_skin_positions(shown.revision, picture->x, out);
}

template class SkinFeed<float>;
template class SkinFeed<double>;

}  // namespace lobe::view
