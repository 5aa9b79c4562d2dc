// The messages on the socket (docs/live_protocol.md): frames out as blocks of bytes, requests in as JSON.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>
#include <vector>

#include "lobe/scene/parse_tool.h"
#include "lobe/snapshot/snapshot.h"

namespace lobe::view {
static_assert(std::endian::native == std::endian::little, "blocks are written as they stand in memory");

// ---- Out: blocks [tag u32][size u32][bytes], little-endian, each filled up to a multiple of four bytes. A
// reader skips those whose tag it does not know.

constexpr std::uint32_t tag(const char (&name)[5]) {
  return std::uint32_t(std::uint8_t(name[0])) | std::uint32_t(std::uint8_t(name[1])) << 8 |
         std::uint32_t(std::uint8_t(name[2])) << 16 | std::uint32_t(std::uint8_t(name[3])) << 24;
}
inline constexpr std::uint32_t topology_tag = tag("TOPO"), positions_tag = tag("POSN"),
                               scalar_tag = tag("SCAL"), tools_tag = tag("TOOL"), obstacles_tag = tag("OBST"),
                               status_tag = tag("STAT"), paint_tag = tag("PNTS"), materials_tag = tag("MATS"),
                               fibres_tag = tag("FIBR"), skin_tag = tag("SKIN"),
                               skin_positions_tag = tag("SKNP"), bodies_tag = tag("BODS"),
                               lines_tag = tag("LINE"), choices_tag = tag("CHOI");

class BlockWriter {
 public:
  void begin(std::uint32_t block_tag);
  template <class T>
  void put(const T& value) {
    put(std::span<const T>(&value, 1));
  }
  template <class T>
  void put(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  }
  void put_text(std::string_view text) { bytes_.append(text); }
  void end();
  std::string take() { return std::move(bytes_); }

 private:
  void fill_up() { bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0'); }

  std::string bytes_;
  std::size_t begin_ = 0;
};

struct Block {
  std::uint32_t tag = 0;
  std::string_view bytes;
};
// Throws InputError for bytes that are no sequence of blocks.
std::vector<Block> read_blocks(std::string_view message);

// Writes all of the surface but present positions: revision, triangles, regions, cut faces, positions at
// rest.
void write_topology(const SurfaceMesh& surface, const Mat3X<float>& rest /* 3 × #vertices [m] */,
                    BlockWriter& out);
// Writes the part of each triangle's fibre that lies in the triangle at rest, as a combination of the sides
// from its first corner to its second and third, so that it follows the triangle. It is zero where there is
// no fibre. Nothing is written if no triangle has one.
void write_fibres(const SurfaceMesh& surface, const Mat3X<float>& rest /* 3 × #vertices [m] */,
                  const Mat3X<double>& fibres /* 3 × #tetrahedra, or no column */, BlockWriter& out);
// Writes which body each triangle is of: its number among the names in the status. Nothing is written where
// there is one body without a name.
void write_bodies(const SurfaceMesh& surface, const MeshBodies& bodies, BlockWriter& out);
// Writes what threads and attachments draw: the number of them; of each the name of its force term in 16
// bytes and the number of its segments; then of all of them ends [m], tensions [N] and damages. Nothing is
// written where there are none.
void write_lines(std::span<const LinesSnapshot> lines, BlockWriter& out);
void write_positions(const SurfaceMesh& surface, const Mat3X<float>& x /* 3 × #vertices [m] */,
                     BlockWriter& out);
// The skin that the body carries (skin/skin.h): its triangles that are shown, and their positions.
void write_skin(std::uint64_t revision, std::span<const Eigen::Vector3i> triangles,
                const Mat3X<float>& rest /* 3 × #vertices [m] */, BlockWriter& out);
void write_skin_positions(std::uint64_t revision, const Mat3X<float>& x /* 3 × #vertices [m] */,
                          BlockWriter& out);
// One number per vertex, in 16 bits. The block gives the range that these stand for.
void write_scalar(std::string_view name, std::span<const float> values, BlockWriter& out);
void write_json(std::uint32_t block_tag, const std::string& json, BlockWriter& out);

// ---- In

namespace request {

template <class T, class Value>
struct Field {
  const char* key;
  Value T::*value;
};
template <class T, class Value>
Field(const char*, Value T::*) -> Field<T, Value>;

// The last frame has been received, so the next one may be sent.
struct Seen {
  static constexpr const char* name = "seen";
  static constexpr auto fields = std::tuple();
};
// A hand grasps what is near the point where a ray enters the body.
struct Take {
  int hand = 0;
  Vec3d from = Vec3d::Zero(), along = Vec3d::Zero();  // [m]; of any length but 0
  double radius = 0;                                  // [m]
  static constexpr const char* name = "take";
  static constexpr auto fields = std::tuple(Field{"hand", &Take::hand}, Field{"from", &Take::from},
                                            Field{"along", &Take::along}, Field{"radius", &Take::radius});
};
// A hand brings a tool, which is off. Its JSON is that of scenes, with "at" in place of "path", and names no
// file (scene/parse_tool.h).
struct Bring {
  int hand = 0;
  ParsedTool tool;
  static constexpr const char* name = "bring";
  static constexpr auto fields = std::tuple(Field{"hand", &Bring::hand}, Field{"tool", &Bring::tool});
};
// A cautery burns, a scalpel cuts, a clip is closed, and jaws close until they press on what is between them;
// or they stop doing so.
struct TurnOn {
  int hand = 0;
  bool on = false;
  static constexpr const char* name = "turn_on";
  static constexpr auto fields = std::tuple(Field{"hand", &TurnOn::hand}, Field{"on", &TurnOn::on});
};
// A hand moves what it holds: the place where it took hold, or the tip of a tool.
struct Lead {
  int hand = 0;
  Vec3d to = Vec3d::Zero();  // [m]
  static constexpr const char* name = "lead";
  static constexpr auto fields = std::tuple(Field{"hand", &Lead::hand}, Field{"to", &Lead::to});
};
struct LetGo {
  int hand = 0;
  static constexpr const char* name = "let_go";
  static constexpr auto fields = std::tuple(Field{"hand", &LetGo::hand});
};
// ---- Thread (lobe/live/sewing.h). The client chooses the number of a thread.

struct Whole {  // a number that may be below 0
  int value = 0;
};
struct TakeThread {
  Whole thread;
  double stiffness = 98, friction = 0.2, strength = 20,
         holds = 1;  // of ThreadMaterial (setup/thread_setup.h)
  static constexpr const char* name = "thread";
  static constexpr auto fields =
      std::tuple(Field{"thread", &TakeThread::thread}, Field{"stiffness", &TakeThread::stiffness},
                 Field{"friction", &TakeThread::friction}, Field{"strength", &TakeThread::strength},
                 Field{"holds", &TakeThread::holds});
};
// Draws it through the tissue, `depth` below the point where a ray enters the body.
struct Stitch {
  Whole thread;
  Vec3d from = Vec3d::Zero(), along = Vec3d::Zero();  // [m]; of any length but 0
  double depth = 0;                                   // [m]
  static constexpr const char* name = "stitch";
  static constexpr auto fields = std::tuple(Field{"thread", &Stitch::thread}, Field{"from", &Stitch::from},
                                            Field{"along", &Stitch::along}, Field{"depth", &Stitch::depth});
};
// Takes its free ends, or leads them to a place; lets go of them.
struct PullThread {
  Whole thread;
  Vec3d to = Vec3d::Zero();  // [m]
  static constexpr const char* name = "pull_thread";
  static constexpr auto fields =
      std::tuple(Field{"thread", &PullThread::thread}, Field{"to", &PullThread::to});
};
struct DropThread {
  Whole thread;
  static constexpr const char* name = "drop_thread";
  static constexpr auto fields = std::tuple(Field{"thread", &DropThread::thread});
};
// Ties a knot between two bites, or draws one together further. Bites are counted from 0; −1 is the last.
struct TieThread {
  Whole thread, first, last;
  double tighten = 0;  // [m]
  static constexpr const char* name = "tie";
  static constexpr auto fields =
      std::tuple(Field{"thread", &TieThread::thread}, Field{"first", &TieThread::first},
                 Field{"last", &TieThread::last}, Field{"tighten", &TieThread::tighten});
};
// Cuts the thread that passes a ray within a distance.
struct CutThreadNear {
  Vec3d from = Vec3d::Zero(), along = Vec3d::Zero();  // [m]; of any length but 0
  double within = 0;                                  // [m]
  static constexpr const char* name = "cut_thread";
  static constexpr auto fields =
      std::tuple(Field{"from", &CutThreadNear::from}, Field{"along", &CutThreadNear::along},
                 Field{"within", &CutThreadNear::within});
};
struct Pause {
  bool on = false;
  static constexpr const char* name = "pause";
  static constexpr auto fields = std::tuple(Field{"on", &Pause::on});
};
struct Step {
  static constexpr const char* name = "step";
  static constexpr auto fields = std::tuple();
};
struct Speed {
  double factor = 1;  // simulated seconds per second
  static constexpr const char* name = "speed";
  static constexpr auto fields = std::tuple(Field{"factor", &Speed::factor});
};
struct Restart {
  static constexpr const char* name = "restart";
  static constexpr auto fields = std::tuple();
};
struct Back {
  double seconds = 1;
  static constexpr const char* name = "back";
  static constexpr auto fields = std::tuple(Field{"seconds", &Back::seconds});
};
// Whether the frames of this client have the scene's skin.
struct Skin {
  bool on = false;
  static constexpr const char* name = "skin";
  static constexpr auto fields = std::tuple(Field{"on", &Skin::on});
};
// Which scalar the frames of this client have: "none", "von_mises", "volume_ratio", "linear_error".
struct Show {
  std::string what;
  static constexpr const char* name = "show";
  static constexpr auto fields = std::tuple(Field{"what", &Show::what});
};
// This client asks for control.
struct Control {
  static constexpr const char* name = "control";
  static constexpr auto fields = std::tuple();
};
// The client in control hands over to the one that asked first, or refuses all that have asked.
struct HandOver {
  static constexpr const char* name = "hand_over";
  static constexpr auto fields = std::tuple();
};
struct Keep {
  static constexpr const char* name = "keep";
  static constexpr auto fields = std::tuple();
};
// Saves what the hands have done, as a scene.
struct Export {
  std::string to;  // name of the files, without folder and extension
  static constexpr const char* name = "export";
  static constexpr auto fields = std::tuple(Field{"to", &Export::to});
};

// ---- Painting. The body is at rest meanwhile.

struct Edit {
  bool on = false;
  static constexpr const char* name = "edit";
  static constexpr auto fields = std::tuple(Field{"on", &Edit::on});
};
// All that lies within a sphere becomes a model of region_model_names (fem/body.h); or its skin "held",
// "free".
struct Paint {
  Vec3d at = Vec3d::Zero();  // point at rest [m]
  double radius = 0;         // [m]
  std::string as;
  static constexpr const char* name = "paint";
  static constexpr auto fields =
      std::tuple(Field{"at", &Paint::at}, Field{"radius", &Paint::radius}, Field{"as", &Paint::as});
};
struct PaintMaterial {
  Vec3d at = Vec3d::Zero();  // point at rest [m]
  double radius = 0;         // [m]
  int material = 0;          // number of the material
  static constexpr const char* name = "paint_material";
  static constexpr auto fields =
      std::tuple(Field{"at", &PaintMaterial::at}, Field{"radius", &PaintMaterial::radius},
                 Field{"material", &PaintMaterial::material});
};
// Precomputed parts that nothing holds become another model, or get a corotated frame: "turning".
struct Mend {
  std::string as;
  static constexpr const char* name = "mend";
  static constexpr auto fields = std::tuple(Field{"as", &Mend::as});
};
// Adds a material like the first one, but with another stiffness.
struct NewMaterial {
  std::string title;
  double young = 0;  // [Pa]
  static constexpr const char* name = "new_material";
  static constexpr auto fields =
      std::tuple(Field{"name", &NewMaterial::title}, Field{"young", &NewMaterial::young});
};
struct PaintAll {
  std::string as;
  static constexpr const char* name = "paint_all";
  static constexpr auto fields = std::tuple(Field{"as", &PaintAll::as});
};
// Ends a stroke of the brush. All that a stroke has painted is undone at once.
struct Stroke {
  static constexpr const char* name = "stroke";
  static constexpr auto fields = std::tuple();
};
struct Undo {
  static constexpr const char* name = "undo";
  static constexpr auto fields = std::tuple();
};
// Asks lobe to choose regions for a given error of the displacement.
struct Propose {
  double tolerance = 0.02;
  static constexpr const char* name = "propose";
  static constexpr auto fields = std::tuple(Field{"tolerance", &Propose::tolerance});
};
// Simulates what has been painted.
struct Apply {
  static constexpr const char* name = "apply";
  static constexpr auto fields = std::tuple();
};
struct Save {
  std::string to;  // as in Export
  static constexpr const char* name = "save";
  static constexpr auto fields = std::tuple(Field{"to", &Save::to});
};

// ---- Other organs

// Opens files that were sent (inbox.h): a scene with its files, or of what a scene is made. An empty text and
// 0 let lobe choose.
struct Open {
  std::vector<std::string> files;
  std::string tissue, hold;
  double springs = 0;          // stiffness of a bed under the side that is held [Pa/m]
  double edge = 0, scale = 0;  // [m]; to metres
  static constexpr const char* name = "open";
  static constexpr auto fields =
      std::tuple(Field{"files", &Open::files}, Field{"tissue", &Open::tissue}, Field{"hold", &Open::hold},
                 Field{"springs", &Open::springs}, Field{"edge", &Open::edge}, Field{"scale", &Open::scale});
};
// Finds out how large the body in files that were sent is, before it is meshed.
struct Measure {
  std::vector<std::string> files;
  static constexpr const char* name = "measure";
  static constexpr auto fields = std::tuple(Field{"files", &Measure::files});
};
// Opens one of the scenes and meshes that come with lobe (library.h).
struct OpenShipped {
  std::string what;
  static constexpr const char* name = "open_shipped";
  static constexpr auto fields = std::tuple(Field{"what", &OpenShipped::what});
};
// Makes the scene anew with other choices. Edge and scale 0: those that it was made with; scale −1: found.
struct Remake {
  std::string tissue, hold;
  double springs = 0;
  std::vector<Vec3d> pins;  // points at rest [m]
  double edge = 0, scale = 0;
  static constexpr const char* name = "remake";
  static constexpr auto fields = std::tuple(Field{"tissue", &Remake::tissue}, Field{"hold", &Remake::hold},
                                            Field{"springs", &Remake::springs}, Field{"pins", &Remake::pins},
                                            Field{"edge", &Remake::edge}, Field{"scale", &Remake::scale});
};
// Measures how far the mesh is from the truth of its own body (linearity/total_error.h).
struct Judge {
  static constexpr const char* name = "judge";
  static constexpr auto fields = std::tuple();
};
// Stops what is being opened or measured.
struct Cancel {
  static constexpr const char* name = "cancel";
  static constexpr auto fields = std::tuple();
};
// Saves the scene that is open, and its mesh.
struct SaveScene {
  std::string to;  // as in Export
  static constexpr const char* name = "save_scene";
  static constexpr auto fields = std::tuple(Field{"to", &SaveScene::to});
};

using Any =
    std::variant<Seen, Take, Bring, TurnOn, Lead, LetGo, TakeThread, Stitch, PullThread, DropThread,
                 TieThread, CutThreadNear, Pause, Step, Speed, Restart, Back, Show, Skin, Control, HandOver,
                 Keep, Export, Edit, Paint, PaintMaterial, NewMaterial, Mend, PaintAll, Stroke, Undo, Propose,
                 Apply, Save, Open, Measure, OpenShipped, Remake, Judge, Cancel, SaveScene>;
}  // namespace request

inline constexpr int hand_count = 8;

struct Request {
  double number = 0;  // number that the client gave it: frames tell the last one that they know of
  request::Any what;
};

// Throws InputError for anything but an object {"do": one of the names above, its fields, "number" if
// wanted}, with finite numbers of a sensible size.
Request parse_request(std::string_view json);

}  // namespace lobe::view
