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

// What is done ahead of a blade, before it cuts.
struct BladeAhead {
  bool expands = false;      // pre-computed regions
  std::vector<Index> freed;  // reduced tetrahedra that become non-linear
  bool operator==(const BladeAhead&) const = default;
  static constexpr auto fields = std::tuple(&BladeAhead::expands, &BladeAhead::freed);
};

// A point of the edge inside the body, as a material point. Stations of contact/places.h are something else.
struct BladeStation {
  Index at = 0;                // number of the point along the edge, from the tip
  Index grain = 0;             // in which it lies
  Vec3d rest = Vec3d::Zero();  // its rest position [m]
  bool is_valid() const { return rest.allFinite(); }
  bool operator==(const BladeStation&) const = default;
  static constexpr auto fields = std::tuple(&BladeStation::at, &BladeStation::grain, &BladeStation::rest);
};
struct BladeRow {       // the edge at the end of a step
  bool is_new = false;  // false: it takes the place of the row before
  std::vector<BladeStation> stations;
  bool operator==(const BladeRow&) const = default;
  static constexpr auto fields = std::tuple(&BladeRow::is_new, &BladeRow::stations);
};

// What a move has cut, step by step, and what the blade knows of the body afterwards. A recording has it, so
// that a replay need not find it again, and that the blade can go on from there.
struct BladeCut {
  using Station = BladeStation;
  using Row = BladeRow;
  struct Step {
    Incision caught_up, incision;
    std::vector<Index> taken_before, taken;  // points that the sheet took, in either
    std::optional<Row> row;                  // none: the blade has not moved
    Vec3d way = Vec3d::Zero();               // Incised has the rest
    Index crumbs = 0, refused = 0;
    bool is_valid() const { return way.allFinite(); }
    bool operator==(const Step&) const = default;
    static constexpr auto fields =
        std::tuple(&Step::caught_up, &Step::incision, &Step::taken_before, &Step::taken, &Step::row,
                   &Step::way, &Step::crumbs, &Step::refused);
  };
  BladePose from;              // where the edge was at the start; the tissue may have carried it there
  std::vector<Station> begun;  // of the edge there, if a stroke begins
  std::vector<Step> steps;     // none: the blade waited
  BladeAhead ahead;
  bool is_valid() const { return from.tip.allFinite() && from.heel.allFinite(); }
  bool operator==(const BladeCut&) const = default;
  static constexpr auto fields =
      std::tuple(&BladeCut::from, &BladeCut::begun, &BladeCut::steps, &BladeCut::ahead);
};

class Blades {
 public:
  explicit Blades(const Elements& elements) : grains(elements) {}

  // The body as it is now.
  struct BodyNow {
    Placements placement;
    std::function<std::vector<Index>(const SweptVolume&)> tets_in;  // that meet it
    CornerPlaces corners;
  };

  // The edge from which a move goes on. The tissue may have carried it along.
  BladePose start_of(const BladeMove& move, const BodyNow& body) const;
  // The steps of a move. What a blade sweeps without turning is flat, however far it goes. So a step goes as
  // far as two edges, but displacements of the blade's ends differ by half an edge at most.
  std::vector<BladeMove> steps(const BladeMove& move) const;
  static std::vector<BladeMove> steps(const BladeMove& move, std::size_t count);
  // Performs one step. The caller then divides the tetrahedra that were opened. Does nothing while 32 other
  // strokes go on. If it is to be listed in `made`, its incisions are there only.
  std::optional<Incised> cut(const BladeMove& step, const BodyNow& body, BladeCut* made = nullptr);
  // Repeats what the step of this number in `made` has done. The stroke goes on from there. Throws InputError
  // for what does not fit the grains.
  Incised repeat(const BladeMove& step, const BladeCut& made, std::size_t number, const BodyNow& body);
  // Ends the strokes that did not go on since the last call.
  void end_strokes();

  Grains grains;

  struct BladePoint {             // of an edge
    Index grain = -1;             // −1: outside the body
    Vec3d rest = Vec3d::Zero();   // in the grain [m]
    Vec3d place = Vec3d::Zero();  // when it was found [m]
    static constexpr auto fields = std::tuple(&BladePoint::grain, &BladePoint::rest, &BladePoint::place);
  };
  using Row = std::vector<BladePoint>;
  struct Stroke {
    int tool = 0, number = 0, bit = 0, rows_made = 0;
    Index begun = 0;        // how many of the body began before
    Index points_seen = 0;  // of the grains, after its last step
    bool goes_on = true;
    std::vector<Row> rows;  // the last few that the edge has left behind, the present one last
    static constexpr auto fields =
        std::tuple(&Stroke::tool, &Stroke::number, &Stroke::bit, &Stroke::rows_made, &Stroke::begun,
                   &Stroke::points_seen, &Stroke::goes_on, &Stroke::rows);
  };
  struct State {  // with the grains, all that a later step depends on
    std::vector<std::uint32_t> on;
    std::vector<Stroke> strokes;
    Index begun = 0;  // strokes since the start
    static constexpr auto fields = std::tuple(&State::on, &State::strokes, &State::begun);
  };
  State state() const { return {grains.on(), strokes_, begun_}; }
  void set_state(const State& state);
  static bool fits(const State& state, const Grains* grains);  // null: there are none

 private:
  Stroke* stroke_of(const BladeMove& step);
  Row first_row(const BladeMove& step, Stroke& stroke) const;
  Incised advance(Stroke& stroke, const BladeMove& step, const BodyNow& body,
                  std::optional<BladeCut::Row>& made);
  Incised catch_up(Stroke& stroke, const BladeMove& step, const BodyNow& body);
  Incised repeat(const Incision& incision, const std::vector<Index>& taken, const Stroke& stroke,
                 const BladeMove& step, const BodyNow& body);
  void put_at(const std::vector<BladeCut::Station>& stations, Row& row) const;
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
