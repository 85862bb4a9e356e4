//! Arrays as pictures and rasters, and back.

use crate::error::refused;
use asperity::surface::picture::{Picture, Samples};
use asperity::surface::raster::Raster;
use numpy::ndarray::Dimension;
use numpy::{
    Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray, PyReadonlyArray2, PyReadonlyArrayDyn,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// The numbers of an array in the order of its axes: one that lies otherwise would come out turned.
fn in_order<'a, T: Element + Copy, D: Dimension>(array: &'a PyReadonlyArray<'_, T, D>) -> PyResult<&'a [T]> {
    if array.is_c_contiguous() {
        Ok(array.as_slice()?)
    } else {
        Err(refused("an array does not lie row after row; give numpy.ascontiguousarray of it"))
    }
}

/// The signals of an array (signals, samples).
pub fn signals<'a>(array: &'a PyReadonlyArray2<'_, f32>) -> PyResult<Vec<&'a [f32]>> {
    let flat = in_order(array)?;
    Ok(match array.shape() {
        [count, 0] => vec![&[]; *count],
        [_, samples] => flat.chunks_exact(*samples).collect(),
        _ => Vec::new(),
    })
}

/// An array (rows, columns) or (rows, columns, channels) of uint8, uint16 or float32.
pub fn picture(array: &Bound<'_, PyAny>) -> PyResult<Picture> {
    let (shape, samples) = if let Ok(array) = array.extract::<PyReadonlyArrayDyn<'_, u8>>() {
        (array.shape().to_vec(), Samples::U8(in_order(&array)?.to_vec()))
    } else if let Ok(array) = array.extract::<PyReadonlyArrayDyn<'_, u16>>() {
        (array.shape().to_vec(), Samples::U16(in_order(&array)?.to_vec()))
    } else if let Ok(array) = array.extract::<PyReadonlyArrayDyn<'_, f32>>() {
        (array.shape().to_vec(), Samples::F32(in_order(&array)?.to_vec()))
    } else {
        return Err(PyTypeError::new_err("a picture is an array of uint8, uint16 or float32"));
    };
    let (rows, columns) = match shape[..] {
        [rows, columns] | [rows, columns, _] => (rows, columns),
        _ => return Err(refused(format!("the array has {} axes; give (rows, columns)", shape.len()))),
    };
    let side = |texels: usize| u32::try_from(texels).unwrap_or(u32::MAX);
    Picture::new(side(columns), side(rows), samples).map_err(refused)
}

/// An array (rows, columns) as a raster.
pub fn raster(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Raster> {
    let [height, width] = [array.shape()[0], array.shape()[1]];
    Ok(Raster { width, height, values: in_order(array)?.to_vec() })
}

/// A raster as an array (rows, columns).
pub fn array(py: Python<'_>, raster: Raster) -> PyResult<Bound<'_, PyArray2<f64>>> {
    PyArray1::from_vec(py, raster.values).reshape([raster.height, raster.width])
}

/// Equally long signals as an array (signals, samples).
pub fn planar(py: Python<'_>, signals: Vec<Vec<f32>>) -> PyResult<Bound<'_, PyArray2<f32>>> {
    let shape = [signals.len(), signals.first().map_or(0, Vec::len)];
    let mut signals = signals;
    let flat = if signals.len() == 1 { signals.swap_remove(0) } else { signals.concat() };
    PyArray1::from_vec(py, flat).reshape(shape)
}
