// Pieces of the report against known answers.
#include <gtest/gtest.h>

#include "host_sim/report/html_text.hpp"
#include "host_sim/report/svg_plot.hpp"

namespace berth::host {
namespace {

std::vector<std::uint8_t> bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

// RFC 4648, section 10.
TEST(Base64, TestVectors) {
  EXPECT_EQ(base64(bytes_of("")), "");
  EXPECT_EQ(base64(bytes_of("f")), "Zg==");
  EXPECT_EQ(base64(bytes_of("fo")), "Zm8=");
  EXPECT_EQ(base64(bytes_of("foo")), "Zm9v");
  EXPECT_EQ(base64(bytes_of("foob")), "Zm9vYg==");
  EXPECT_EQ(base64(bytes_of("foobar")), "Zm9vYmFy");
}

TEST(Html, TextIsEscaped) { EXPECT_EQ(escape_html("<a&\"b\">"), "&lt;a&amp;&quot;b&quot;&gt;"); }

TEST(Svg, PlotOfNothingIsNothing) {
  EXPECT_EQ(to_svg(ScatterPlot{"t", "x", "y", true, {{"s", "red", {}, false}}}), "");
  EXPECT_EQ(to_svg(BarPlot{}), "");
}

TEST(Svg, OnePointAndZeroOnALogarithmicAxisAreDrawn) {
  const std::string svg =
      to_svg(ScatterPlot{"t", "x", "y", true, {{"s", "red", {{5, 0.1}, {6, 0.0}}, false}}});
  EXPECT_NE(svg.find("<circle"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

}  // namespace
}  // namespace berth::host
