#include "lobe/fit/parameters.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "lobe/error.h"
#include "lobe/fem/transverse_isotropy.h"
#include "lobe/scene/material_constants.h"

namespace lobe {
namespace {

void set_lame(double E, double nu, Elastic& material) {
  const LamePair lame = lame_from_young(E, nu);
  material.lambda = lame.lambda;
  material.mu = lame.mu;
}

double poisson(const Elastic& e) { return poisson_ratio(e.lambda, e.mu); }
double young(const Elastic& e) { return young_modulus(e.lambda, e.mu); }
bool is_isotropic(const Material& m) { return !m.transverse; }
bool any_material(const Material&) { return true; }
template <std::size_t i>
bool has_further(const Material& m) {
  return law_rows[std::size_t(m.law)].keys[i] != nullptr;
}

void scale(double factor, const Elastic& start, Elastic& material) {
  material.lambda = factor * start.lambda;
  material.mu = factor * start.mu;
  material.fibre = start.fibre.times(factor);
  for (std::size_t i = 0; i < law_rows[std::size_t(start.law)].moduli; ++i)
    material.further[i] = factor * start.further[i];
}

// A number of a term of a Prony series that is there.
template <std::size_t i, double PronyTerm::*number>
bool has_prony(const Material& m) {
  return m.viscosity[i].*number > 0;
}
template <std::size_t i, double PronyTerm::*number>
double prony(const Elastic& e, const Elastic&) {
  return e.viscosity[i].*number;
}
template <std::size_t i, double PronyTerm::*number>
void set_prony(double value, const Elastic&, Elastic& e) {
  e.viscosity[i].*number = value;
}

struct Kind {
  const char* name;  // null: that of the law's further modulus
  ParameterScale scale;
  bool (*is_of)(const Material&);
  double (*value)(const Elastic&, const Elastic& at_start);
  void (*set)(double value, const Elastic& at_start, Elastic&);
  bool in_motion = false;
};

template <std::size_t i, double PronyTerm::*number>
constexpr Kind prony_kind(const char* name, ParameterScale scale) {
  return {name, scale, has_prony<i, number>, prony<i, number>, set_prony<i, number>, true};
}

static_assert(most_prony_terms == 3);
const Kind kinds[] = {
    {"young_modulus", ParameterScale::logarithmic, is_isotropic,
     [](const Elastic& e, const Elastic&) { return young(e); },
     [](double value, const Elastic&, Elastic& e) { set_lame(value, poisson(e), e); }},
    {"poisson_ratio", ParameterScale::below_half, is_isotropic,
     [](const Elastic& e, const Elastic&) { return poisson(e); },
     [](double value, const Elastic&, Elastic& e) { set_lame(young(e), value, e); }},
    {"density", ParameterScale::logarithmic, any_material,
     [](const Elastic& e, const Elastic&) { return e.density; },
     [](double value, const Elastic&, Elastic& e) { e.density = value; }},
    {"stiffness", ParameterScale::logarithmic, any_material,
     [](const Elastic& e, const Elastic& start) { return e.mu / start.mu; }, scale},
    {nullptr, ParameterScale::linear, has_further<0>,
     [](const Elastic& e, const Elastic&) { return e.further[0]; },
     [](double value, const Elastic&, Elastic& e) { e.further[0] = value; }},
    {nullptr, ParameterScale::linear, has_further<1>,
     [](const Elastic& e, const Elastic&) { return e.further[1]; },
     [](double value, const Elastic&, Elastic& e) { e.further[1] = value; }},
    prony_kind<0, &PronyTerm::shear>("prony_shear_1", ParameterScale::share),
    prony_kind<0, &PronyTerm::bulk>("prony_bulk_1", ParameterScale::share),
    prony_kind<0, &PronyTerm::time>("prony_time_1", ParameterScale::logarithmic),
    prony_kind<1, &PronyTerm::shear>("prony_shear_2", ParameterScale::share),
    prony_kind<1, &PronyTerm::bulk>("prony_bulk_2", ParameterScale::share),
    prony_kind<1, &PronyTerm::time>("prony_time_2", ParameterScale::logarithmic),
    prony_kind<2, &PronyTerm::shear>("prony_shear_3", ParameterScale::share),
    prony_kind<2, &PronyTerm::bulk>("prony_bulk_3", ParameterScale::share),
    prony_kind<2, &PronyTerm::time>("prony_time_3", ParameterScale::logarithmic),
};

double stiffness_of(const SceneAttachment& attachment) {  // [Pa/m] of a bed, [N/m] of a ligament
  return std::visit([](const auto& what) { return what.stiffness; }, attachment.what);
}

const Parameter* find(const std::vector<Parameter>& known, const Scene& scene, const std::string& name) {
  for (const Parameter& parameter : known)
    if (parameter.name == name) return &parameter;
  const std::string whole = scene.materials.size() == 1 && name.find('.') == std::string::npos
                                ? scene.materials[0].name + "." + name
                                : name;
  for (const Parameter& parameter : known)
    if (parameter.name == whole) return &parameter;
  return nullptr;
}

}  // namespace

std::vector<Parameter> all_parameters(const Scene& scene) {
  std::vector<Parameter> found;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    const Elastic start = elastic_of(material);
    std::size_t further = 0;
    for (std::size_t row = 0; row < std::size(kinds); ++row) {
      const Kind& kind = kinds[row];
      if (!kind.is_of(material)) continue;
      const char* name = kind.name ? kind.name : law_rows[std::size_t(material.law)].keys[further++];
      found.push_back({.name = material.name + "." + name,
                       .number = m,
                       .row = row,
                       .start = kind.value(start, start),
                       .unit = start.mu,
                       .scale = kind.scale,
                       .in_motion = kind.in_motion,
                       .at_start = start});
    }
  }
  for (std::size_t a = 0; a < scene.attachments.size(); ++a)
    found.push_back({.name = "attachments." + scene.attachments[a].name + ".stiffness",
                     .of = Parameter::Of::attachment,
                     .number = a,
                     .start = stiffness_of(scene.attachments[a]),
                     .in_motion = true});
  if (scene.time.damping > 0)
    found.push_back(
        {.name = "damping", .of = Parameter::Of::body, .start = scene.time.damping, .in_motion = true});
  return found;
}

double Parameter::on_scale(double value) const {
  switch (scale) {
    case ParameterScale::logarithmic:
      return std::log(value);
    case ParameterScale::below_half:
      return std::log(0.5 - value);
    case ParameterScale::share:
      return std::log(value / (1 - value));
    case ParameterScale::linear:
      break;
  }
  return value / unit;
}

double Parameter::from_scale(double x) const {
  switch (scale) {
    case ParameterScale::logarithmic:
      return std::exp(x);
    case ParameterScale::below_half:
      return 0.5 - std::exp(x);
    case ParameterScale::share:
      return 1 / (1 + std::exp(-x));
    case ParameterScale::linear:
      break;
  }
  return x * unit;
}

namespace {

// A factor of all moduli says nothing beside one of them.
void refuse_factor_beside_moduli(const std::vector<Parameter>& found, std::vector<Fault>& faults) {
  const auto is = [](const Parameter& p, const char* name) {
    return p.name.ends_with(std::string(".") + name);
  };
  for (const Parameter& factor : found)
    for (const Parameter& other : found)
      if (is(factor, "stiffness") && factor.of == Parameter::Of::material &&
          other.of == Parameter::Of::material && other.number == factor.number && !other.in_motion &&
          !is(other, "stiffness") && !is(other, "density"))
        faults.push_back({factor.name, "is a factor of all moduli: it does not go with " + other.name});
}

}  // namespace

std::vector<Parameter> find_parameters(const Scene& scene, const std::vector<std::string>& names) {
  const std::vector<Parameter> known = all_parameters(scene);
  std::vector<Parameter> found;
  std::vector<Fault> faults;
  for (const std::string& name : names) {
    const Parameter* parameter = find(known, scene, name);
    const auto same = [&](const Parameter& other) { return parameter && other.name == parameter->name; };
    if (!parameter) {
      std::string all;
      for (const Parameter& each : known) all += (all.empty() ? "" : ", ") + each.name;
      faults.push_back({name, "is no parameter of the scene; it has " + all});
    } else if (std::any_of(found.begin(), found.end(), same)) {
      faults.push_back({name, "is asked for twice"});
    } else {
      found.push_back(*parameter);
    }
  }
  refuse_factor_beside_moduli(found, faults);
  if (!faults.empty()) throw InputError(std::move(faults));
  return found;
}

double value_of(const Parameter& parameter, const Elastic& material) {
  return kinds[parameter.row].value(material, parameter.at_start);
}

void set(const Parameter& parameter, double value, Elastic& material) {
  kinds[parameter.row].set(value, parameter.at_start, material);
}

namespace {

void set(const Parameter& parameter, double value, Material& material) {
  Elastic changed = elastic_of(material);
  set(parameter, value, changed);
  material.lame_lambda = changed.lambda;
  material.lame_mu = changed.mu;
  material.density = changed.density;
  material.further = changed.further;
  material.viscosity = changed.viscosity;
  if (material.transverse) material.transverse = transverse_constants(changed);
}

// Strands of a bed have an area. What tears takes ½ k c δ_f² (22.2), or the tension k δ_f.
void make_stiffer(double factor, AttachmentSetup& attachment) {
  for (StrandSetup& strand : attachment.strands) strand.stiffness *= factor;
  const bool is_bed = !attachment.strands.empty() && attachment.strands.front().area > 0;
  attachment.holds_until /= is_bed ? std::sqrt(factor) : factor;
}

}  // namespace

void set(const Parameter& parameter, double value, Setup& setup) {
  switch (parameter.of) {
    case Parameter::Of::material:
      return set(parameter, value, setup.materials[parameter.number]);
    case Parameter::Of::attachment:
      return make_stiffer(value / parameter.start, setup.attachments[parameter.number]);
    case Parameter::Of::body:
      setup.damping = value;
  }
}

void set(const Parameter& parameter, double value, Scene& scene) {
  switch (parameter.of) {
    case Parameter::Of::material:
      return set(parameter, value, scene.materials[parameter.number]);
    case Parameter::Of::attachment:
      return std::visit([&](auto& what) { what.stiffness = value; },
                        scene.attachments[parameter.number].what);
    case Parameter::Of::body:
      scene.time.damping = value;
  }
}

}  // namespace lobe
