//! Bytes to be filled in any order.

use glam::IVec3;
use tyndall_core::Spectrum;

#[derive(Debug)]
pub(super) struct Buffer(Vec<u8>);

impl Buffer {
    /// So many zeros.
    pub(super) fn new(size: u64) -> Result<Self, String> {
        let too_large =
            || format!("it takes {size} bytes, more than there is memory: write it smaller");
        let size = usize::try_from(size).map_err(|_| too_large())?;
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(size).map_err(|_| too_large())?;
        bytes.resize(size, 0);
        Ok(Self(bytes))
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.0
    }

    pub(super) fn put(&mut self, at: usize, bytes: &[u8]) {
        self.0[at..at + bytes.len()].copy_from_slice(bytes);
    }

    pub(super) fn put_u32(&mut self, at: usize, x: u32) {
        self.put(at, &x.to_le_bytes());
    }

    pub(super) fn put_u64(&mut self, at: usize, x: u64) {
        self.put(at, &x.to_le_bytes());
    }

    pub(super) fn put_f32s(&mut self, at: usize, all: &[f32]) {
        for (i, x) in all.iter().enumerate() {
            self.put(at + size_of_val(x) * i, &x.to_le_bytes());
        }
    }

    pub(super) fn put_f64s(&mut self, at: usize, all: &[f64]) {
        for (i, x) in all.iter().enumerate() {
            self.put(at + size_of_val(x) * i, &x.to_le_bytes());
        }
    }

    /// First and last voxel of a box.
    pub(super) fn put_box(&mut self, at: usize, bounds: [IVec3; 2]) {
        for (i, end) in bounds.into_iter().enumerate() {
            self.put_voxel(at + size_of_val(&end) * i, end);
        }
    }

    pub(super) fn put_voxel(&mut self, at: usize, voxel: IVec3) {
        for (i, x) in voxel.to_array().into_iter().enumerate() {
            self.put(at + size_of_val(&x) * i, &x.to_le_bytes());
        }
    }

    pub(super) fn put_value<T: Spectrum>(&mut self, at: usize, value: T) {
        for c in 0..T::CHANNELS {
            self.put_f32s(at + size_of::<f32>() * c, &[value.channel(c)]);
        }
    }

    /// Sets a bit of the mask that begins at `at`.
    pub(super) fn set_bit(&mut self, at: usize, bit: usize) {
        self.0[at + bit / 8] |= 1 << (bit % 8);
    }
}
