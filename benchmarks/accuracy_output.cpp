// The table and the plots of `lobe bench accuracy`.
#include <algorithm>
#include <iomanip>
#include <sstream>

#include "benchmarks/accuracy.h"

namespace lobe::bench {
namespace {

// Two plots per scene: total error, model error. Colours are models; full points single, hollow ones double
// precision; the larger the point, the finer the mesh; squares the Pareto front.
constexpr const char* accuracy_plot_script = R"gp(set datafile separator ','
set logscale xy
set format y '%g'
set grid xtics ytics mytics
set key outside right noenhanced
set xlabel 'wall time per simulated second [s]'
set linetype 1 lc '#c02020'
set linetype 2 lc '#0060ad'
set linetype 3 lc '#20a0d0'
set linetype 4 lc '#2e8b30'
set linetype 5 lc '#e08000'
set linetype 6 lc '#8040a0'
set linetype 7 lc '#808000'
set linetype 8 lc '#606060'
set linetype 9 lc '#d060a0'
set linetype 10 lc '#00a090'
set linetype 11 lc '#a06030'
of(s, m, p, y) = (strcol(8) eq s && strcol(1) eq m && strcol(2) eq p) ? y : NaN
on_front(s, y) = (strcol(8) eq s && strcol(10) eq '1') ? y : NaN
size(tets) = 0.7 * (tets / 300.0)**0.25
points = "plot for [i=1:words(models)] 'accuracy.csv' using 5:(of(s, word(models, i), 'single', column(y))):(size($3)) with points lc i pt 7 ps variable title word(models, i), for [i=1:words(models)] '' using 5:(of(s, word(models, i), 'double', column(y))):(size($3)) with points lc i pt 6 ps variable lw 1.5 notitle"
front = "'' using 5:(on_front(s, column(y))) with points lc 'black' pt 4 ps 2.6 title 'Pareto front'"
total = "y = 7; set ylabel 'error against the fine mesh'; set title s.': total error' noenhanced; @points, @front"
model = "y = 6; set ylabel 'error against SVK on this mesh'; set title s.': model error' noenhanced; @points"
do for [s in scenes] {
  set terminal pngcairo size 1700,620 font 'sans,11'
  set output 'accuracy_'.s.'.png'
  set multiplot layout 1,2
  @total
  @model
  unset multiplot
}
set terminal pngcairo size 1700,620*words(scenes) font 'sans,11'
set output 'accuracy.png'
set multiplot layout words(scenes),2
do for [s in scenes] {
  @total
  @model
}
unset multiplot
)gp";

std::string unique_words(const std::vector<AccuracyRow>& rows, std::string AccuracyRow::*name) {
  std::vector<std::string> seen;
  std::string words;
  for (const AccuracyRow& row : rows) {
    if (std::find(seen.begin(), seen.end(), row.*name) != seen.end()) continue;
    seen.push_back(row.*name);
    words += (words.empty() ? "" : " ") + row.*name;
  }
  return words;
}

}  // namespace

std::string accuracy_csv(const std::vector<AccuracyRow>& rows) {
  std::ostringstream out;
  out << "model,precision,tets,dt_s,wall_s_per_s,error_model,error_total,scene,safety,pareto,threads,"
         "linear_fraction,model_reference_change,total_reference_change,status\n"
      << std::setprecision(4);
  const auto number = [&](bool known, double value) {
    if (known) out << value;
    out << ',';
  };
  for (const AccuracyRow& r : rows) {
    out << r.model << ',' << r.precision << ',' << r.tets << ',';
    number(r.to_the_end, r.dt);
    number(r.to_the_end, r.wall_per_s);
    number(r.to_the_end, r.error_model);
    number(r.to_the_end && r.has_total, r.error_total);
    out << r.scene << ',' << r.safety << ',' << r.pareto << ',' << r.threads << ',' << r.linear_fraction
        << ',' << r.model_reference_change << ',';
    number(r.has_total, r.total_reference_change);
    out << r.status << '\n';
  }
  return out.str();
}

std::string accuracy_plot(const std::vector<AccuracyRow>& rows) {
  return "scenes = '" + unique_words(rows, &AccuracyRow::scene) + "'\nmodels = '" +
         unique_words(rows, &AccuracyRow::model) + "'\n" + accuracy_plot_script;
}

}  // namespace lobe::bench
