// Files without the heap: reading files and replacing them as a whole. Standard types only.
#pragma once
#include <cstddef>
#include <cstdint>

namespace platform {

struct FileError {
  char text[256] = {0};  // what is wrong and how to mend it, without the path
};

// Files are read, never mapped: data checked in memory must not change when the file does. A mapped file could change
// after the check, or be truncated, which ends a program with SIGBUS.

// A regular file open for reading, and its size when opened.
struct FileReader {
  int descriptor = -1;
  std::uint64_t byte_count = 0;
};

// Never waits. An empty file is an error, and so is anything other than a regular file.
bool open_reader(const char* path, FileReader* reader, FileError* error);
// Reads the next `byte_count` bytes. Fails if the file ends earlier.
bool read_bytes(FileReader* reader, void* bytes, std::size_t byte_count, FileError* error);
void close_reader(FileReader* reader);

// A whole file in memory outside the heap.
struct LoadedFile {
  const std::uint8_t* bytes = nullptr;  // aligned to a page; null: not loaded
  std::size_t byte_count = 0;
};
bool load_file(const char* path, LoadedFile* file, FileError* error);
void unload_file(LoadedFile* file);

// Calls found() with the name of every entry of a folder that does not begin with a dot, in no particular order. Only
// for start-up: the system takes memory for it.
bool list_folder(const char* path, void (*found)(void* context, const char* name), void* context, FileError* error);

// Makes a folder within an existing one. Returns true even if it exists.
bool make_folder(const char* path, FileError* error);

// Makes a private folder in the folder for temporary files (TMPDIR or /tmp) and writes its path to `path`. The caller
// removes it.
bool make_temporary_folder(char* path, std::size_t path_bytes, FileError* error);
// Removes a folder and its files, except those whose names begin with a dot; a folder that contains folders stays.
void remove_folder(const char* path);

// Changes whenever the file's content is replaced; 0 if there is no such file.
std::uint64_t file_stamp(const char* path);

// Writes a file so that readers see either the old content or the whole new one, even after a power cut: into
// PATH.NUMBER.part, which no other program uses; close_writer() flushes it to the disk and renames it.
// - A symbolic link stays, and its target is written.
// - An existing file keeps its permissions, and its owner and group if the system allows that. A file without write
//   permission is refused, even if its folder would allow a new one.
// - Anything other than a regular file (a device, a pipe, a FIFO) is written directly, as are standard output ("-",
//   /dev/stdout) and other descriptors (/dev/fd/3). A FIFO without a reader is waited for, see stop_waiting_if().
constexpr std::size_t kWriterPathBytes = 1024;
struct FileWriter {
  int descriptor = -1;
  bool failed = false;
  char path[kWriterPathBytes] = {0};       // the file to replace at the end; empty: written directly
  char part[kWriterPathBytes + 32] = {0};  // the file written until then
};
bool open_writer(const char* path, FileWriter* writer, FileError* error);
// open_writer() calls this periodically while it waits for a FIFO's reader; true: it gives up. Null: it keeps waiting.
void stop_waiting_if(bool (*stopped)());
// After a failure further data is ignored; close_writer() reports the failure.
void write_bytes(FileWriter* writer, const void* bytes, std::size_t byte_count);
// Overwrites bytes written before. Returns false, with no effect, if they are written directly.
bool rewrite_bytes(FileWriter* writer, std::uint64_t offset, const void* bytes, std::size_t byte_count);
bool close_writer(FileWriter* writer, FileError* error);
// Gives up: removes the data written; an older file of that name stays.
void discard_writer(FileWriter* writer);

// Opens a file that has its final name while it grows: PATH holds these bytes, or its previous content; write_bytes()
// then appends, and close_writer() ends it. For names that the user did not choose: anything of that name is replaced,
// never followed or opened, even a symbolic link or a pipe. A file keeps its permissions.
bool open_growing_writer(const char* path, const void* bytes, std::size_t byte_count, FileWriter* writer,
                         FileError* error);

// From here on, only writers of "-" reach standard output, and printed text goes to standard error. Fails if standard
// output is a terminal.
bool keep_output_for_data(FileError* error);
bool is_output_for_data();

// Returns whether open_writer() would succeed; call before work whose result goes there. Does not open pipes.
bool can_write(const char* path, FileError* error);
// Returns whether open_writer() would write there directly.
bool is_device_or_pipe(const char* path);
// Returns whether the last name of a path is a regular file, not a link to one, or does not exist.
bool is_plain_or_absent(const char* path);
// Returns whether two paths name one file, through links of either kind; the file need not exist yet. False for devices
// and pipes.
bool is_same_file(const char* one, const char* other);

// Returns whether standard error is a terminal.
bool stderr_is_terminal();

}  // namespace platform
