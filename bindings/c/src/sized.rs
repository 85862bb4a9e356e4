//! Sized structs: each begins with its own size, so that a program and a library of different ages
//! understand each other.
//!
//! A struct only ever grows at its end. The library knows every size it has shipped: what a
//! program's older struct lacks has its default, and a size that never was is refused instead of
//! read. From the day on which a struct grows it is filled by `asp_init_…`, which is told the size
//! and which the header calls; `asp_…_init` of the library goes on for programs of before, and
//! fills what they have room for.

use crate::entry::aligned;
use crate::status::{ASP_BAD_ARGUMENT, Failure};

/// A struct that begins with its size.
///
/// # Safety
/// The first field is the `u32` size, and every bit pattern of the others is a value.
pub(crate) unsafe trait Sized32: Copy {
    /// Its name in C.
    const NAME: &'static str;
    /// Every size it ever had, the last its present one.
    const SHIPPED: &'static [u32];

    /// Its size and its defaults.
    fn initial() -> Self {
        zeroed()
    }
}

fn refused<T: Sized32>(size: u32) -> Failure {
    let (name, own) = (T::NAME, size_of::<T>());
    let right = format!("call {name}_init first, with the header of this library ({own} bytes)");
    Failure::new(ASP_BAD_ARGUMENT, format!("{name}: struct_size: {size} is refused; {right}"))
}

/// Copies a program's struct, whatever its age.
pub(crate) fn read<T: Sized32>(from: *const T, name: &str) -> Result<T, Failure> {
    read_within(from, u32::MAX, name)
}

/// Copies one of a program's structs that lie `room` bytes apart, whatever their age.
pub(crate) fn read_within<T: Sized32>(from: *const T, room: u32, name: &str) -> Result<T, Failure> {
    aligned(from, name)?;
    // SAFETY: not null and aligned; the first field is a u32 in every age of the struct.
    let size = unsafe { from.cast::<u32>().read() };
    if size > room || !T::SHIPPED.contains(&size) {
        return Err(refused::<T>(size));
    }
    let mut copy = T::initial();
    // SAFETY: a size that was shipped is at most our own, and the program's struct has it.
    unsafe {
        std::ptr::copy_nonoverlapping(from.cast::<u8>(), (&raw mut copy).cast::<u8>(), size as usize);
    }
    Ok(copy)
}

/// Writes into a program's struct as much as it has room for.
pub(crate) fn write<T: Sized32>(value: &T, to: *mut T, name: &str) -> Result<(), Failure> {
    aligned(to, name)?;
    // SAFETY: as in `read`.
    let size = unsafe { to.cast::<u32>().read() };
    if !T::SHIPPED.contains(&size) {
        return Err(refused::<T>(size));
    }
    put(value, to, size);
    Ok(())
}

/// Writes a struct of that size, which was shipped.
pub(crate) fn put<T: Sized32>(value: &T, to: *mut T, size: u32) {
    // SAFETY: a size that was shipped is at most our own, and the caller's struct has it; the
    // fields follow the size in front.
    unsafe {
        to.cast::<u32>().write(size);
        std::ptr::copy_nonoverlapping(
            std::ptr::from_ref(value).cast::<u8>().add(4),
            to.cast::<u8>().add(4),
            size as usize - 4,
        );
    }
}

/// Fills a struct of that size that a program has just made; a size that never was fills nothing.
pub(crate) fn init_as<T: Sized32>(to: *mut T, size: u32) {
    if !to.is_null() && to.is_aligned() && T::SHIPPED.contains(&size) {
        put(&T::initial(), to, size);
    }
}

/// Fills a struct that a program has just made.
pub(crate) fn init<T: Sized32>(to: *mut T) {
    if !to.is_null() && to.is_aligned() {
        // SAFETY: not null and aligned; that it is a T is the caller's promise.
        unsafe { to.write(T::initial()) };
    }
}

/// A struct of zeros and null pointers that knows its size.
pub(crate) fn zeroed<T: Sized32>() -> T {
    // SAFETY: every bit pattern is a value, and the first field is the u32 size.
    unsafe {
        let mut zeroed: T = std::mem::zeroed();
        (&raw mut zeroed).cast::<u32>().write(size_of::<T>() as u32);
        zeroed
    }
}

/// Says how a struct of the header begins, if not with zeros; the sizes that it had before stand in
/// brackets.
macro_rules! sized {
    ($type:ident $(, [$($older:expr),*])? $(, |$zeroed:ident| $initial:expr)?) => {
        // SAFETY: `repr(C)`, the size comes first, and all fields are numbers and pointers.
        unsafe impl $crate::sized::Sized32 for $type {
            const NAME: &'static str = stringify!($type);
            const SHIPPED: &'static [u32] = &[$($($older as u32,)*)? size_of::<Self>() as u32];
            $(
                fn initial() -> Self {
                    let $zeroed = $crate::sized::zeroed::<Self>();
                    $initial
                }
            )?
        }
    };
}
pub(crate) use sized;
