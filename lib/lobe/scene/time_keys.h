// Keys of `time` and `output` (docs/scene/time.md). Internal, not part of the public interface.
#pragma once

#include "lobe/error.h"
#include "lobe/scene/key_table.h"

namespace lobe {

inline void after_reading(const nlohmann::json& object, Time&) {
  const auto sleep = object.find("sleep");
  if (sleep != object.end() && *sleep == true)
    throw InputError("/time/sleep",
                     "true does not say by how much displacements may differ: give that in m, or leave it "
                     "out, and sessions choose it");
}

}  // namespace lobe

namespace lobe::keys {

template <>
inline constexpr std::array words_of<Precision>{"single", "double"};
template <>
inline constexpr std::array words_of<Integrator>{"explicit", "implicit"};

template <>
inline constexpr auto table_of<Time> = Table(
    "time", R"({"removed": {"mass_scaling": "use \"selective_mass\", which lengthens steps by more"}})",

    Key("duration", &Time::duration, above(0).in("s"), "how long to simulate"),
    Key("frame", &Time::frame, above(0).in("s"),
        "length of a frame: tools and cuts act at its start. It takes as many steps as stability needs"),
    Key("damping", &Time::damping, at_least(0).in("1/s"),
        "mass-proportional damping γ: free motions fall as exp(−γt/2)"),
    Key("safety", &Time::safety, above(0).up_to(1), "time step as a fraction of the stability limit 2/ω_max"),
    Key("cut_step", &Time::cut_step, at_least(0).up_to(1),
        "share of the uncut body's time step that scalpels should leave: vertices of divided tetrahedra get "
        "mass that resists acceleration and has no weight; 0 adds none. Explicit integrator only"),
    Key("selective_mass", &Time::selective_mass, at_least(1).up_to(highest_mass_degree),
        "degree of selective masses, which make time steps longer. 1: masses are lumped. Explicit "
        "integrator only"),
    Key("ramp", &Time::ramp, at_least(0).in("s"), "time over which prescribed displacements are reached"),
    Key("load_ramp", &Time::load_ramp, at_least(0).in("s"),
        "time over which tractions, pressures and forces grow to their full size; gravity acts at once"),
    Key("precision", &Time::precision, any,
        "of explicit dynamics; implicit ones are always computed in double"),
    Key("integrator", &Time::integrator, any,
        "central differences, or generalised-α with Newton's method: the reference in time, and for scenes "
        "too stiff for explicit steps; always in double precision"),
    Key("step", &Time::step, at_least(0).in("s"),
        "longest step of the implicit integrator; 0: one step per frame"),
    Key("spectral_radius", &Time::spectral_radius, at_least(0).up_to(1),
        "of the implicit integrator at high frequencies: 1 damps nothing (implicit midpoint rule), 0 "
        "annihilates what the step cannot resolve"),
    Key("sleep", &Time::sleep, at_least(0).in("m").or_false().optional(),
        "by how much displacements may differ where parts at rest sleep; 0 or `false`: none sleeps"),
    Key("own_steps", &Time::own_steps, any,
        "whether parts that may take longer steps than the stiffest part do so: twice, four times, up to 32 "
        "times as long. Explicit integrator only"));

template <>
inline constexpr auto table_of<Output> =
    Table("output", "", Key("every", &Output::every, above(0).in("s"), "time between two VTU frames"),
          Key("pictures", &Output::pictures, at_least(0).in("s"), "times of PNG pictures"));

}  // namespace lobe::keys
