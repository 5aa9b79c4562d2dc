// What a scene shows in motion at the times of measurements.
#pragma once

#include <optional>
#include <string>

#include "lobe/fit/observe.h"

namespace lobe {

// Plays a setup in double precision, as `lobe run` does, up to the last time of the measurements. Frames end
// as in that command, `frame` seconds apart, and at the times of measurements. The force on an entry of
// "boundary" is that of the moment, the force of a tool the mean over the frame. Returns the values in the
// measurements' order and units, or nothing if the motion could not be computed; `trouble` then says why.
// Throws InputError if the setup is inconsistent. Costs as much as that run.
std::optional<Eigen::VectorXd> values_in_motion(const Setup& setup, const Observations& observed,
                                                double frame,  // [s]
                                                std::string& trouble);

}  // namespace lobe
