// Files without the heap: reading one, replacing one as a whole. Standard types only.
#pragma once
#include <cstddef>
#include <cstdint>

namespace platform {

struct FileError {
  char text[256] = {0};  // what is wrong and how to mend it, without the path
};

// Files are read, never mapped: what has been checked in memory stays as it is, whatever becomes of the file. Under a
// mapping it could change after the check, or be cut short, which ends a program with SIGBUS.

// A regular file that is open for reading, and its size at that moment.
struct FileReader {
  int descriptor = -1;
  std::uint64_t byte_count = 0;
};

// An empty file is an error, and so is all that is not a regular file; nothing is waited for.
bool open_reader(const char* path, FileReader* reader, FileError* error);
// The next `byte_count` bytes. Fails where the file ends before them.
bool read_bytes(FileReader* reader, void* bytes, std::size_t byte_count, FileError* error);
void close_reader(FileReader* reader);

// A whole file in memory that is not the heap's.
struct LoadedFile {
  const std::uint8_t* bytes = nullptr;  // aligned to a page; null: not loaded
  std::size_t byte_count = 0;
};
bool load_file(const char* path, LoadedFile* file, FileError* error);
void unload_file(LoadedFile* file);

// Calls found() with the name of everything in a folder but what begins with a dot, in no order. At the start only: the
// system takes memory for it.
bool list_folder(const char* path, void (*found)(void* context, const char* name), void* context, FileError* error);

// Makes a folder within one that is there. Also true where it is there already.
bool make_folder(const char* path, FileError* error);

// Makes a folder that no other program uses, where files that pass lie (TMPDIR or /tmp), and puts its path into `path`.
// The caller's to remove.
bool make_temporary_folder(char* path, std::size_t path_bytes, FileError* error);
// Removes a folder with the files in it, but for those whose names begin with a dot; one with folders in it stays.
void remove_folder(const char* path);

// Changes whenever the file's content was replaced; 0 where there is no such file.
std::uint64_t file_stamp(const char* path);

// Writes a file so that readers see the old content or the whole new one, even after a power cut: into
// PATH.NUMBER.part, which no other program uses; close_writer() brings it to the disk and renames it.
// - A symbolic link stays and its target is written.
// - A file that is there keeps its permissions, and its owner and group where the system allows that. One that may not
//   be written is refused, though its folder would allow a new one.
// - What is no regular file (a device, a pipe, a FIFO) is written directly, as are standard output ("-", /dev/stdout)
//   and other descriptors (/dev/fd/3).
constexpr std::size_t kWriterPathBytes = 1024;
struct FileWriter {
  int descriptor = -1;
  bool failed = false;
  char path[kWriterPathBytes] = {0};       // what is replaced in the end; empty: written directly
  char part[kWriterPathBytes + 32] = {0};  // written until then
};
bool open_writer(const char* path, FileWriter* writer, FileError* error);
// After a failure the rest is ignored; close_writer() reports it.
void write_bytes(FileWriter* writer, const void* bytes, std::size_t byte_count);
bool close_writer(FileWriter* writer, FileError* error);
// Gives up: what was written is removed, an older file of that name stays.
void discard_writer(FileWriter* writer);

// Whether open_writer() would succeed: to be asked before work whose result goes there. A pipe is not opened.
bool can_write(const char* path, FileError* error);
// Whether open_writer() writes directly there.
bool is_device_or_pipe(const char* path);
// Whether two paths name one file, through links of both kinds; also one that does not exist yet. False for devices and
// pipes.
bool is_same_file(const char* one, const char* other);

// Whether a person watches standard error.
bool stderr_is_terminal();

}  // namespace platform
