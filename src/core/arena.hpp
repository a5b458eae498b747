// Model, State and Workspace: one block of memory each, with a header and the arrays of fields.def behind it. There are
// no pointers in a block: offsets follow from the counts in its header, so a copy of a block is as good as the block.
#pragma once

#include "types.hpp"

namespace RW_VARIANT {

enum Dimension : I64 {
#define DIMENSION(name, meaning) name,
#define MODEL(...)
#define STATE(...)
#define WORK(...)
#include "fields.def"
    DIMENSIONS
};
enum class Part : I64 { MODEL, STATE, WORK };
enum class Values : I64 { FINITE, NOT_NEGATIVE, POSITIVE, FLAG, FEW, COUNT, NODE, RUN, OPTION };

// The table as text: what Python reads, and what the seal of every block is made of.
constexpr char TABLE[] =
#define DIMENSION(name, meaning) "DIMENSION\t" #name "\t" meaning "\n"
#define MODEL(name, type, rows, columns, values, unit, meaning) \
    "MODEL\t" #name "\t" #type "\t" #rows "\t" #columns "\t" #values "\t" unit "\t" meaning "\n"
#define STATE(name, type, rows, columns, values, unit, meaning) \
    "STATE\t" #name "\t" #type "\t" #rows "\t" #columns "\t" #values "\t" unit "\t" meaning "\n"
#define WORK(name, type, rows, columns, values, unit, meaning) \
    "WORK\t" #name "\t" #type "\t" #rows "\t" #columns "\t" #values "\t" unit "\t" meaning "\n"
#include "fields.def"
    ;

constexpr U64 seal_of(const char* text) {  // Fowler, Noll and Vo
    U64 hash = 0xcbf29ce484222325u;
    for (; *text; text++) hash = (hash ^ static_cast<unsigned char>(*text)) * 0x100000001b3u;
    return hash;
}

struct Field {
    Part part;
    bool is_index;  // I64, else double
    Dimension rows, columns;
    Values values;
};

template <class T>
inline constexpr bool IS_INDEX = __is_same(T, I64);

constexpr Field FIELDS[] = {
#define DIMENSION(...)
#define MODEL(name, type, rows, columns, values, ...) {Part::MODEL, IS_INDEX<type>, rows, columns, Values::values},
#define STATE(name, type, rows, columns, values, ...) {Part::STATE, IS_INDEX<type>, rows, columns, Values::values},
#define WORK(name, type, rows, columns, values, ...) {Part::WORK, IS_INDEX<type>, rows, columns, Values::values},
#include "fields.def"
};
constexpr I64 FIELD_COUNT = sizeof FIELDS / sizeof FIELDS[0];

constexpr I64 LINE = 64;    // bytes that every row is aligned to
constexpr I64 BLOCK = 128;  // nodes that a step moves at once
constexpr I64 MARGIN = 16;  // numbers behind every row, and around those of the scratch space, that vectors may read
constexpr I64 SCRATCH_ROWS = 5;  // for each axis
constexpr I64 SCRATCH_ROW = BLOCK + 2 * MARGIN;
constexpr I64 SCRATCH_SIZE = 3 * SCRATCH_ROWS * SCRATCH_ROW;
constexpr I64 SHARED = 8;         // nodes that share the point of a contact, one after the other
constexpr I64 RECORD_SIZE = 112;  // numbers of the record of a contact
constexpr I64 HEADER = 256;       // bytes

struct Header {
    U64 seal;
    Part part;
    I64 bytes;
    I64 is_bound;  // of a Workspace: rw_bind has checked its Model and State
    I64 counts[DIMENSIONS];
};
static_assert(sizeof(Header) <= HEADER);

// Numbers from one row of an array to the next.
constexpr I64 stride_of(I64 columns) { return (columns + 7) / 8 * 8 + MARGIN; }
constexpr I64 size_of(const Field& field, const I64* counts) {
    return counts[field.rows] * stride_of(counts[field.columns]);
}

// A block as it lies in memory.
struct Arena {
    char* base;

    Header& header() const { return *reinterpret_cast<Header*>(base); }
};

// An array of a block. The checked build stops where an index leads out of it.
template <class T>
struct View {
    T* data;
#ifdef RW_CHECKED
    I64 size;
    T* at(I64 i, I64 count = 1) const {
        if (i < 0 || i + count > size) __builtin_trap();
        return data + i;
    }
#else
    T* at(I64 i, I64 = 1) const { return data + i; }
#endif
    T& operator[](I64 i) const { return *at(i); }
};

// Hands out the arrays of a block in the order of the table.
struct Cursor {
    char* next;
    const I64* counts;

    explicit Cursor(Arena arena) : next(arena.base + HEADER), counts(arena.header().counts) {}
    template <class T>
    void take(View<T>& view, Dimension rows, Dimension columns) {
        const I64 size = counts[rows] * stride_of(counts[columns]);
        view.data = reinterpret_cast<T*>(next);
#ifdef RW_CHECKED
        view.size = size;
#endif
        next += size * static_cast<I64>(sizeof(T));
    }
};

struct Model {
    I64 axes, nodes, viscous, runs, springs, bands, joints, contacts, collectors, sheaves, parts;
    I64 stride;         // of arrays of nodes
    const I64* counts;  // of all dimensions
#define DIMENSION(...)
#define MODEL(name, type, ...) View<const type> name;
#define STATE(...)
#define WORK(...)
#include "fields.def"

    explicit Model(Arena arena) : counts(arena.header().counts) {
        axes = counts[AXES], nodes = counts[NODES], viscous = counts[VISCOUS];
        runs = counts[RUNS], springs = counts[SPRINGS], bands = counts[BANDS], joints = counts[JOINTS],
        contacts = counts[CONTACTS], collectors = counts[COLLECTORS], sheaves = counts[SHEAVES], parts = counts[PARTS];
        stride = stride_of(nodes);
        Cursor cursor(arena);
#define DIMENSION(...)
#define MODEL(name, type, rows, columns, ...) cursor.take(name, rows, columns);
#define STATE(...)
#define WORK(...)
#include "fields.def"
    }
};

struct State {
#define DIMENSION(...)
#define MODEL(...)
#define STATE(name, type, ...) View<type> name;
#define WORK(...)
#include "fields.def"

    explicit State(Arena arena) {
        Cursor cursor(arena);
#define DIMENSION(...)
#define MODEL(...)
#define STATE(name, type, rows, columns, ...) cursor.take(name, rows, columns);
#define WORK(...)
#include "fields.def"
    }
};

// A node of a run that is like most of its inner ones.
inline I64 typical_node(const State& s, I64 run) { return s.run_first[run] + (s.run_links[run] + 1) / 3; }

struct Workspace {
#define DIMENSION(...)
#define MODEL(...)
#define STATE(...)
#define WORK(name, type, ...) View<type> name;
#include "fields.def"

    explicit Workspace(Arena arena) {
        Cursor cursor(arena);
#define DIMENSION(...)
#define MODEL(...)
#define STATE(...)
#define WORK(name, type, rows, columns, ...) cursor.take(name, rows, columns);
#include "fields.def"
    }
};

}  // namespace RW_VARIANT
