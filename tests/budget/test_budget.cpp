// What the budget is made of: link map, stack frames and calls, on texts whose answer is seen by
// eye.
#include <gtest/gtest.h>

#include "host_sim/budget/budget.hpp"
#include "host_sim/budget/link_map.hpp"
#include "host_sim/budget/modules.hpp"

namespace berth::host {
namespace {

constexpr const char* kMap = R"(
Memory Configuration

Name             Origin             Length             Attributes
FLASH            0x00000000         0x0001fc00         xr
RAM              0x20000000         0x00060000         rw
*default*        0x00000000         0xffffffff

Linker script and memory map

LOAD a.obj

.text           0x00000000       0x30
 .text.short    0x00000000       0x10 algo/liba.a(one.cpp.obj)
 .text._ZN5berth17a_rather_long_nameEi
                0x00000010       0x0c algo/liba.a(two.cpp.obj)
                0x00000010                berth::a_rather_long_name(int)
 .text.gone     0x00000000        0x0 algo/liba.a(two.cpp.obj)
 *fill*         0x0000001c        0x4
 .rodata.table  0x00000020        0x8 algo/liba.a(two.cpp.obj)
 .text          0x00000028        0x8 /usr/lib/libgcc.a(_udivmoddi4.o)

.bss            0x20000000       0x40
 .bss.state     0x20000000       0x40 main/main.cpp.obj

.debug_line     0x00000000       0x99
 .debug_line    0x00000000       0x99 algo/liba.a(one.cpp.obj)
)";

TEST(LinkMap, reads_long_names_and_leaves_out_what_is_not_in_the_image) {
  const auto sections = parse_link_map(kMap);
  ASSERT_TRUE(sections);
  ASSERT_EQ(sections->size(), 5u);
  EXPECT_EQ((*sections)[1].input, ".text._ZN5berth17a_rather_long_nameEi");
  EXPECT_EQ((*sections)[1].object, "two.cpp.obj");
  EXPECT_EQ((*sections)[1].bytes, 12u);
  EXPECT_EQ((*sections)[4].address, 0x20000000u);
}

TEST(LinkMap, says_what_is_missing_in_a_file_that_is_no_map) {
  EXPECT_FALSE(parse_link_map("hello"));
}

TEST(LinkMap, reads_the_memories_without_the_default_one) {
  const auto regions = parse_memory_regions(kMap);
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0].bytes, 127u * 1024);
  EXPECT_EQ(regions[1].name, "RAM");
}

TEST(Modules, adds_up_code_constants_and_data_by_folder) {
  const FolderOfObject folders = {
      {"one.cpp.obj", "algo/edge"}, {"two.cpp.obj", "algo/pose"}, {"main.cpp.obj", "main"}};
  const auto modules = bytes_per_module(*parse_link_map(kMap), folders);
  EXPECT_EQ(modules.at("algo/edge").code, 16u);
  EXPECT_EQ(modules.at("algo/pose").code, 12u);
  EXPECT_EQ(modules.at("algo/pose").constants, 8u);
  EXPECT_EQ(modules.at("main").data, 64u);
  EXPECT_EQ(modules.at("compiler and C library").code, 8u);
}

TEST(Modules, folder_of_a_built_file_is_the_source_folder) {
  EXPECT_EQ(source_folder("algo/CMakeFiles/berth_algo.dir/edge/link.cpp.ci"), "algo/edge");
  EXPECT_EQ(source_folder("firmware/main/CMakeFiles/berthmark.dir/__/storage/storage.cpp.ci"),
            "firmware/storage");
}

FrameSizes frames_of(const std::string& text) {
  FrameSizes frames;
  EXPECT_TRUE(add_frame_sizes(text, frames));
  return frames;
}

std::string node(const std::string& title, const std::string& usage) {
  return "node: { title: \"" + title + "\" label: \"f\\nfile.cpp:1:1\\n" + usage + "\" }\n";
}

TEST(FrameSizes, takes_the_larger_of_two_local_functions_of_one_name) {
  const auto frames =
      frames_of(node("a.cpp:f", "16 bytes (static)") + node("b.cpp:f", "40 bytes (static)") +
                node("c.cpp:f", "8 bytes (dynamic,bounded)"));
  EXPECT_EQ(frames.at("f"), 40);
}

TEST(FrameSizes, refuses_a_frame_without_a_bound) {
  FrameSizes frames;
  EXPECT_FALSE(add_frame_sizes(node("f", "16 bytes (dynamic)"), frames));
}

// main calls near (8) and, through a pointer, far; far tail-calls the library's leaf, which pushes
// four registers and takes 8 bytes more.
constexpr const char* kCode =
    "00000000 <vectors>:\n"
    "   0:\t.word\t0x00000101\n"
    "00000100 <main>:\n"
    " 100:\tpush\t{r3, lr}\n"
    " 102:\tbl\t200 <near>\n"
    " 106:\tblx\tr3\n"
    " 108:\tb.n\t102 <main+0x2>\n"
    " 10c:\t.word\t0x00000301\n"
    "00000200 <near>:\n"
    " 200:\tbx\tlr\n"
    "00000300 <far>:\n"
    " 300:\tb.w\t400 <leaf>\n"
    "00000400 <leaf>:\n"
    " 400:\tstmdb\tsp!, {r4-r6, lr}\n"
    " 404:\tsub\tsp, #8\n"
    " 406:\tldmia.w\tsp!, {r4-r6, pc}\n";

TEST(CallGraph, follows_calls_tail_calls_and_pointers_to_the_deepest_end) {
  const FrameSizes frames = {{"main", 8}, {"near", 20}, {"far", 4}};
  const auto path = deepest_path(parse_disassembly(kCode, 4), frames, "main");
  ASSERT_TRUE(path);
  EXPECT_EQ(path->functions, (std::vector<std::string>{"main", "far", "leaf"}));
  EXPECT_EQ(path->bytes, 8 + 4 + 16 + 8);
}

TEST(CallGraph, an_address_in_the_vector_table_is_no_target_of_a_pointer) {
  EXPECT_EQ(parse_disassembly(kCode, 4).addressed, (std::set<std::uint32_t>{0x300}));
}

TEST(CallGraph, finds_recursion_through_other_functions) {
  const std::string code = std::string(kCode) + " 40a:\tbl\t100 <main>\n";
  const auto path = deepest_path(parse_disassembly(code, 4), {}, "main");
  ASSERT_FALSE(path);
  EXPECT_NE(path.error().find("calls itself"), std::string::npos);
}

TEST(CallGraph, finds_a_function_that_calls_itself_directly) {
  const std::string code = "00000100 <f>:\n 100:\tnop\n 102:\tbl\t100 <f>\n";
  EXPECT_FALSE(deepest_path(parse_disassembly(code, 0), {}, "f"));
}

TEST(CallGraph, says_when_the_entry_is_missing) {
  EXPECT_FALSE(deepest_path(parse_disassembly(kCode, 4), {}, "nobody"));
}

}  // namespace
}  // namespace berth::host
