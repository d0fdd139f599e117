//! Reads accessors: rows of numbers in a buffer, perhaps interleaved, packed or sparse.

use super::document::Document;
use crate::Error;
use gltf::json::accessor::{Accessor, ComponentType, Type, sparse};
use gltf::json::validation::Checked;
use gltf::json::{self, Index};

/// Values of `N` components each; `field` is who asks for them. Integers that are normalised become
/// fractions.
pub(super) fn read<const N: usize>(
    document: &Document,
    index: Index<Accessor>,
    field: &str,
) -> Result<Vec<[f32; N]>, Error> {
    let reader = Reader::new(document, index, field)?;
    reader.expect_components(N)?;
    let mut values = vec![[0.0; N]; reader.count];
    reader.fill(|i, value| values[i] = value)?;
    Ok(values)
}

/// Whole numbers: the vertices of triangles.
pub(super) fn read_indices(
    document: &Document,
    index: Index<Accessor>,
    field: &str,
) -> Result<Vec<u32>, Error> {
    let reader = Reader::new(document, index, field)?;
    reader.expect_components(1)?;
    use ComponentType::{U8, U16, U32};
    if !matches!(reader.component, U8 | U16 | U32) {
        let kind = reader.component.as_gl_enum();
        let why = format!("has componentType {kind}, but indices are 5121, 5123 or 5125");
        return Err(reader.fault(format!("{why}: export again")));
    }
    let mut values = vec![0; reader.count];
    for (i, bytes) in reader.base()?.enumerate() {
        values[i] = unsigned(reader.component, bytes);
    }
    reader.substitutes(|i, bytes| values[i] = unsigned(reader.component, bytes))?;
    Ok(values)
}

/// How many values an accessor has.
pub(super) fn count(document: &Document, index: Index<Accessor>) -> u64 {
    document.root.accessors[index.value()].count.0
}

struct Reader<'a> {
    document: &'a Document,
    accessor: &'a Accessor,
    field: String,
    component: ComponentType,
    kind: Type,
    count: usize,
}

impl<'a> Reader<'a> {
    /// Its count is known to be backed by the file.
    fn new(document: &'a Document, index: Index<Accessor>, field: &str) -> Result<Self, Error> {
        let field = format!("{field} (accessors[{}])", index.value());
        let accessor = &document.root.accessors[index.value()];
        let (Checked::Valid(component), Checked::Valid(kind)) =
            (accessor.component_type, accessor.type_)
        else {
            return Err(document.error(field, "has an unknown type: export again"));
        };
        let reader = Self {
            document,
            accessor,
            field,
            component: component.0,
            kind,
            count: accessor.count.0 as usize,
        };
        if reader.count == 0 {
            return Err(reader.fault("has no values: leave it out".into()));
        }
        reader.base().map(drop)?;
        let bytes = accessor
            .count
            .0
            .saturating_mul(4 * kind.multiplicity() as u64);
        document.spend(usize::try_from(bytes).unwrap_or(usize::MAX), &reader.field)?;
        Ok(reader)
    }

    fn fault(&self, problem: String) -> Error {
        self.document.error(&self.field, problem)
    }

    fn expect_components(&self, n: usize) -> Result<(), Error> {
        let scalars_or_vectors = matches!(
            self.kind,
            Type::Scalar | Type::Vec2 | Type::Vec3 | Type::Vec4
        );
        if scalars_or_vectors && self.kind.multiplicity() == n {
            return Ok(());
        }
        let names = ["SCALAR", "VEC2", "VEC3", "VEC4"];
        let wanted = names[n - 1];
        Err(self.fault(format!("has a type other than {wanted}: export again")))
    }

    fn element_size(&self) -> usize {
        self.component.size() * self.kind.multiplicity()
    }

    /// The bytes of each value; none if all are zero.
    fn base(&self) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, Error> {
        let Some(view) = self.accessor.buffer_view else {
            return Ok(Elements::default());
        };
        let (bytes, stride) = self.document.view(view)?;
        let stride = stride.unwrap_or(self.element_size());
        let offset = self.accessor.byte_offset.unwrap_or_default().0;
        self.elements(bytes, offset, stride, self.count)
    }

    fn elements(
        &self,
        bytes: &'a [u8],
        offset: u64,
        stride: usize,
        count: usize,
    ) -> Result<Elements<'a>, Error> {
        let size = self.element_size();
        if stride < size {
            let why = format!("has a byteStride of {stride} for values of {size} bytes");
            return Err(self.fault(format!("{why}: export again")));
        }
        let span = (count as u64 - 1).checked_mul(stride as u64);
        let end = span.and_then(|s| s.checked_add(size as u64)?.checked_add(offset));
        if end.is_none_or(|end| end > bytes.len() as u64) {
            let held = bytes.len();
            let why = format!("reaches beyond its buffer view, which has {held} bytes");
            return Err(self.fault(format!("{why}: export again")));
        }
        Ok(Elements {
            bytes: &bytes[offset as usize..],
            stride,
            size,
            left: count,
        })
    }

    fn fill<const N: usize>(&self, mut set: impl FnMut(usize, [f32; N])) -> Result<(), Error> {
        let size = self.component.size();
        let decode = |bytes: &[u8]| {
            let mut parts = bytes.chunks_exact(size);
            [(); N].map(|()| {
                let part = parts.next().unwrap_or_default();
                number(self.component, self.accessor.normalized, part)
            })
        };
        for (i, bytes) in self.base()?.enumerate() {
            set(i, decode(bytes));
        }
        self.substitutes(|i, bytes| set(i, decode(bytes)))
    }

    /// The values of a sparse accessor that differ from the rest.
    fn substitutes(&self, mut set: impl FnMut(usize, &[u8])) -> Result<(), Error> {
        let Some(sparse) = &self.accessor.sparse else {
            return Ok(());
        };
        let fault = |problem: &str| {
            let field = format!("{}.sparse", self.field);
            self.document
                .error(field, format!("{problem}: export again"))
        };
        let count = sparse.count.0 as usize;
        if count == 0 || count > self.count {
            return Err(fault("must replace at least one value and at most all"));
        }
        let places = self.sparse_indices(&sparse.indices, count)?;
        if !places.is_sorted_by(|a, b| a < b) || places.last() >= Some(&self.count) {
            return Err(fault(
                "has indices that do not increase or are out of range",
            ));
        }
        let values = &sparse.values;
        let (bytes, _) = self.document.view(values.buffer_view)?;
        let size = self.element_size();
        let elements = self.elements(bytes, values.byte_offset.0, size, count)?;
        for (i, bytes) in places.into_iter().zip(elements) {
            set(i, bytes);
        }
        Ok(())
    }

    fn sparse_indices(&self, indices: &sparse::Indices, count: usize) -> Result<Vec<usize>, Error> {
        let (bytes, _) = self.document.view(indices.buffer_view)?;
        let Checked::Valid(json::accessor::IndexComponentType(component)) = indices.component_type
        else {
            return Err(self.fault("has sparse indices of an unknown type: export again".into()));
        };
        let scalars = Reader {
            field: format!("{}.sparse.indices", self.field),
            component,
            kind: Type::Scalar,
            ..*self
        };
        let offset = indices.byte_offset.0;
        let elements = scalars.elements(bytes, offset, component.size(), count)?;
        Ok(elements.map(|b| unsigned(component, b) as usize).collect())
    }
}

#[derive(Default)]
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    left: usize,
}

impl<'a> Iterator for Elements<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        self.left = self.left.checked_sub(1)?;
        let element = &self.bytes[..self.size];
        self.bytes = self.bytes.get(self.stride..).unwrap_or_default();
        Some(element)
    }
}

/// A component; normalised as glTF 2.0, §3.11 has it: c/127, c/255, c/32767, c/65535, at least −1.
fn number(component: ComponentType, normalized: bool, bytes: &[u8]) -> f32 {
    let (value, largest) = match (component, bytes) {
        (ComponentType::I8, &[b]) => (f64::from(b as i8), 127.0),
        (ComponentType::U8, &[b]) => (f64::from(b), 255.0),
        (ComponentType::I16, &[a, b]) => (f64::from(i16::from_le_bytes([a, b])), 32767.0),
        (ComponentType::U16, &[a, b]) => (f64::from(u16::from_le_bytes([a, b])), 65535.0),
        (ComponentType::U32, &[a, b, c, d]) => {
            (f64::from(u32::from_le_bytes([a, b, c, d])), 4_294_967_295.0)
        }
        (ComponentType::F32, &[a, b, c, d]) => return f32::from_le_bytes([a, b, c, d]),
        _ => return 0.0,
    };
    if normalized {
        (value / largest).max(-1.0) as f32
    } else {
        value as f32
    }
}

fn unsigned(component: ComponentType, bytes: &[u8]) -> u32 {
    match (component, bytes) {
        (ComponentType::U8, &[b]) => b.into(),
        (ComponentType::U16, &[a, b]) => u16::from_le_bytes([a, b]).into(),
        (ComponentType::U32, &[a, b, c, d]) => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    }
}
