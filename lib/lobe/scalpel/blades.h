// Blades on their way through a body that moves. The edge of a blade is a row of points. Points inside the
// body are stored as places in the material until the next step. The sheet starts at the present positions of
// these places. So tissue that moves across a blade is cut, and tissue that moves along with it is not.
#pragma once

#include <optional>

#include "lobe/cut/cautery.h"
#include "lobe/scalpel/incise.h"

namespace lobe {

struct BladePose {
  Vec3d tip = Vec3d::Zero(), heel = Vec3d::Zero();  // [m]
  bool operator==(const BladePose&) const = default;
  static constexpr auto fields = std::tuple(&BladePose::tip, &BladePose::heel);
};

// Part of a stroke: a blade's way from when it began to cut to when it stopped.
struct BladeMove {
  int tool = 0, stroke = 0;
  double snap = 0.1;
  BladePose from, to;
  bool along_faces = false;
};

class Blades {
 public:
  explicit Blades(const Elements& elements) : grains(elements) {}

  // The body as it is now.
  struct BodyNow {
    Placements placement;
    std::function<std::vector<Index>(const SweptVolume&)> tets_in;  // tetrahedra that meet a volume
    CornerPlaces corners;
  };

  // The edge from which a move goes on. The tissue may have carried it along.
  BladePose start_of(const BladeMove& move, const BodyNow& body) const;
  // The steps of a move. What a blade sweeps without turning is flat, however far it goes. So a step goes as
  // far as two edges, but displacements of the blade's ends differ by half an edge at most.
  std::vector<BladeMove> steps(const BladeMove& move) const;
  // Performs one step. The caller then divides the tetrahedra that were opened. Does nothing while 32 other
  // strokes go on.
  std::optional<Incised> cut(const BladeMove& step, const BodyNow& body);
  // Ends the strokes that did not go on since the last call.
  void end_strokes();

  Grains grains;

  struct BladePoint {             // a point of an edge
    Index grain = -1;             // −1: outside the body
    Vec3d rest = Vec3d::Zero();   // place in the grain at rest [m]
    Vec3d place = Vec3d::Zero();  // place when it was found [m]
    static constexpr auto fields = std::tuple(&BladePoint::grain, &BladePoint::rest, &BladePoint::place);
  };
  using Row = std::vector<BladePoint>;
  struct Stroke {
    int tool = 0, number = 0, bit = 0, rows_made = 0;
    Index begun = 0;        // number of the body's strokes that began before
    Index points_seen = 0;  // points of the grains after its last step
    bool goes_on = true;
    std::vector<Row> rows;  // last few rows that the edge has left behind, the present one last
    static constexpr auto fields =
        std::tuple(&Stroke::tool, &Stroke::number, &Stroke::bit, &Stroke::rows_made, &Stroke::begun,
                   &Stroke::points_seen, &Stroke::goes_on, &Stroke::rows);
  };
  struct State {  // all that a later step depends on, besides the grains
    std::vector<std::uint32_t> on;
    std::vector<Stroke> strokes;
    Index begun = 0;  // strokes since the start
    static constexpr auto fields = std::tuple(&State::on, &State::strokes, &State::begun);
  };
  State state() const { return {grains.on(), strokes_, begun_}; }
  void set_state(const State& state);
  static bool fits(const State& state, const Grains* grains);  // grains: null if there are none

 private:
  Stroke* stroke_of(const BladeMove& step);
  Row first_row(const BladeMove& step, Stroke& stroke) const;
  Incised advance(Stroke& stroke, const BladeMove& step, const BodyNow& body);
  Incised catch_up(Stroke& stroke, const BladeMove& step, const BodyNow& body);
  std::vector<Index> follow_divided(Stroke& stroke) const;
  void find_stations_again(Stroke& stroke, const std::vector<Index>& divided) const;
  std::vector<Index> tets_near(const SweptSheets& swept, const Blade& blade, const BodyNow& body) const;
  Row places_at(const BladePose& pose, Stroke& stroke, std::size_t count) const;
  void find_in_body(Row& row, const PlacedTets& tets) const;
  static Vec3d way_of(const Row& now, const Row& before, const std::vector<Vec3d>& there,
                      const std::vector<Vec3d>& from);
  std::vector<Vec3d> places_of(const Row& row, const BodyNow& body) const;
  static bool has_moved_since(const Row& row, const std::vector<Vec3d>& places);
  bool is_new_beside(const Row& row, const std::vector<Vec3d>& before) const;
  static void keep(Row row, bool is_new, Stroke& stroke);

  std::vector<Stroke> strokes_;
  Index begun_ = 0;
};

}  // namespace lobe
