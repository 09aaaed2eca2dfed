// SPDX-License-Identifier: Apache-2.0
#include "handpiece/record/session/hdf5_object.h"

#include <hdf5.h>

#include <utility>

namespace handpiece::session {

Hdf5Object& Hdf5Object::operator=(Hdf5Object&& other) noexcept {
    if (this != &other) {
        close();
        id_ = std::exchange(other.id_, -1);
    }
    return *this;
}

void Hdf5Object::close() noexcept {
    if (id_ >= 0) H5Idec_ref(id_);
    id_ = -1;
}

std::int64_t fileType(NumberType type) {
    switch (type) {
        case NumberType::u8:
            return H5T_STD_U8LE;
        case NumberType::u16:
            return H5T_STD_U16LE;
        case NumberType::u32:
            return H5T_STD_U32LE;
        case NumberType::i32:
            return H5T_STD_I32LE;
        case NumberType::u64:
            return H5T_STD_U64LE;
        case NumberType::i64:
            return H5T_STD_I64LE;
        case NumberType::f32:
            return H5T_IEEE_F32LE;
        case NumberType::f64:
            return H5T_IEEE_F64LE;
    }
    return -1;
}

std::int64_t memoryType(NumberType type) {
    switch (type) {
        case NumberType::u8:
            return H5T_NATIVE_UINT8;
        case NumberType::u16:
            return H5T_NATIVE_UINT16;
        case NumberType::u32:
            return H5T_NATIVE_UINT32;
        case NumberType::i32:
            return H5T_NATIVE_INT32;
        case NumberType::u64:
            return H5T_NATIVE_UINT64;
        case NumberType::i64:
            return H5T_NATIVE_INT64;
        case NumberType::f32:
            return H5T_NATIVE_FLOAT;
        case NumberType::f64:
            return H5T_NATIVE_DOUBLE;
    }
    return -1;
}

Hdf5Object textType(std::size_t bytes) {
    Hdf5Object type(H5Tcopy(H5T_C_S1));
    H5Tset_size(type.id(), bytes > 0 ? bytes : 1);
    H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
    H5Tset_cset(type.id(), H5T_CSET_UTF8);
    return type;
}

Hdf5Object eventRowType() {
    Hdf5Object type(H5Tcreate(H5T_COMPOUND, sizeof(EventRow)));
    H5Tinsert(type.id(), "tick", offsetof(EventRow, tick), H5T_STD_U64LE);
    H5Tinsert(type.id(), "part", offsetof(EventRow, part), H5T_STD_U32LE);
    H5Tinsert(type.id(), "name", offsetof(EventRow, name), textType(sizeof(EventRow::name)).id());
    H5Tinsert(type.id(), "text", offsetof(EventRow, text), textType(sizeof(EventRow::text)).id());
    return type;
}

Hdf5Object keyFrameRowType() {
    Hdf5Object type(H5Tcreate(H5T_COMPOUND, sizeof(KeyFrameRow)));
    H5Tinsert(type.id(), "tick", offsetof(KeyFrameRow, tick), H5T_STD_U64LE);
    H5Tinsert(type.id(), "offset", offsetof(KeyFrameRow, offset), H5T_STD_U64LE);
    H5Tinsert(type.id(), "bytes", offsetof(KeyFrameRow, bytes), H5T_STD_U64LE);
    H5Tinsert(type.id(), "hash", offsetof(KeyFrameRow, hash), H5T_STD_U64LE);
    return type;
}

void silenceHdf5() {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace handpiece::session
