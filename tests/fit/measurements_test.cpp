#include "lobe/fit/measurements.h"

#include <doctest/doctest.h>

#include "lobe/error.h"
#include "near.h"

using namespace lobe;
using lobe::test::near;

namespace {

const std::string header = "quantity,at,component,value,unit,sigma\n";

std::string fault_of(const std::string& text) {
  try {
    parse_measurements(text, "data.csv");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a table of measurements is read in any order of its columns, in any unit, with comments") {
  const std::vector<Measurement> read = parse_measurements(
      "unit, value ,component,at,quantity\r\n"
      "# the marker at the tip\n"
      "mm,-6.54,z,0.1 0  0.024,displacement\r\n"
      "\n"
      "mN,510,length,2,force\n"
      "kHz,0.0077,,1,frequency\n",
      "data.csv");
  REQUIRE(read.size() == 3);
  CHECK(read[0].quantity == Quantity::displacement);
  CHECK(read[0].point == Vec3d(0.1, 0, 0.024));
  CHECK(read[0].component == 2);
  CHECK(read[0].value == near(-0.00654, 1e-15));
  CHECK(read[0].sigma == 0);
  CHECK(read[0].line == 3);
  CHECK(read[1].quantity == Quantity::force);
  CHECK(read[1].number == 2);
  CHECK(read[1].component == length_of_vector);
  CHECK(read[1].value == near(0.51, 1e-15));
  CHECK(read[2].value == near(7.7, 1e-15));
  CHECK(read[2].number == 1);
}

TEST_CASE("sigma has the unit of its value") {
  CHECK(parse_measurements(header + "displacement,0 0 0,x,1,mm,0.1\n", "f")[0].sigma == near(1e-4, 1e-15));
}

TEST_CASE("what is wrong with a table is said by line, all at once") {
  CHECK(fault_of("quantity,at,value\n").find("no column \"component\"") != std::string::npos);
  const std::string all = fault_of(header + "length,0,x,1,m,\nforce,0.5,x,1,N,\nforce,0,x,1,,\n");
  CHECK(all.find("data.csv:2: \"length\" is no quantity") != std::string::npos);
  CHECK(all.find("data.csv:3") != std::string::npos);
  CHECK(all.find("data.csv:4: unit \"\" of a force must be one of N, mN") != std::string::npos);
  CHECK(fault_of(header + "force,0,x,nan,N,\n").find("\"nan\" is no finite number") != std::string::npos);
  CHECK(fault_of(header + "force,0,x,1e999,N,\n").find("no finite number") != std::string::npos);
  CHECK(fault_of(header + "force,0,w,1,N,\n").find("must be one of x, y, z, length") != std::string::npos);
  CHECK(fault_of(header + "force,0,x,-12,5,N,\n").find("decimals need a point") != std::string::npos);
  CHECK(fault_of("quantity,at,component,value,unit,sigm\n").find("column \"sigm\" is unknown") !=
        std::string::npos);
  CHECK(parse_measurements("\xEF\xBB\xBF" + header + "force,0,x,1,N,\n", "f").size() == 1);
  CHECK(fault_of(header + "displacement,0 0,x,1,m,\n").find("\"x y z\" [m]") != std::string::npos);
  CHECK(fault_of(header + "frequency,0,,1,Hz,\n").find("1 for the lowest") != std::string::npos);
  CHECK(fault_of(header + "force,0,x,1,N,0\n").find("sigma must be positive") != std::string::npos);
  CHECK(fault_of(header + "force,0,x,1,N,0.1\nforce,0,y,1,N,\n").find("for every number, or for none") !=
        std::string::npos);
  CHECK(fault_of(header).find("has no measurement") != std::string::npos);
  CHECK(fault_of("").find("has no measurement") != std::string::npos);
}
