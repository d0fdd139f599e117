//! A TOML file as a tree whose every value knows where it is written.

use crate::error::{Error, Place};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and its place.
#[derive(Debug)]
pub(crate) struct Node {
    pub(crate) value: Value,
    /// Where the value stands.
    pub(crate) place: Place,
    /// Where its key stands; the value itself for elements of arrays.
    pub(crate) key: Place,
}

#[derive(Debug)]
pub(crate) enum Value {
    String(String),
    Integer(i64),
    Float(f64),
    Bool(bool),
    Date,
    Array(Vec<Node>),
    Table(BTreeMap<String, Node>),
}

impl Value {
    /// What it is, for messages.
    pub(crate) fn describe(&self) -> String {
        match self {
            Self::String(s) => format!("the string {s:?}"),
            Self::Integer(i) => format!("the number {i}"),
            Self::Float(x) => format!("the number {x}"),
            Self::Bool(b) => format!("the boolean {b}"),
            Self::Date => "a date".into(),
            Self::Array(a) => format!("an array of {}", a.len()),
            Self::Table(_) => "a table".into(),
        }
    }
}

/// Parses the text of a file.
pub(crate) fn parse(path: &str, text: &str) -> Result<Node, Error> {
    let source = Source::new(path, text);
    let table = DeTable::parse(text).map_err(|e| Error::Syntax {
        place: source.place(&e.span().unwrap_or(0..0)),
        problem: match e.message() {
            problem @ "duplicate key" => format!("{problem}: remove one"),
            problem => problem.to_owned(),
        },
    })?;
    let place = source.place(&(0..0));
    Ok(Node {
        value: source.table(table.into_inner())?,
        key: place.clone(),
        place,
    })
}

/// Parses the value of an override; a bare word is a string.
pub(crate) fn parse_override(key: &str, text: &str) -> Result<Node, Error> {
    let place = Place::Override(format!("{key}={text}").into());
    let bare = |c: char| c.is_alphanumeric() || "_-./ ".contains(c);
    let value = match DeValue::parse(text) {
        Ok(value) => Source::new("", text).node(value, place.clone())?.value,
        Err(_) if text.starts_with(char::is_alphabetic) && text.chars().all(bare) => {
            Value::String(text.into())
        }
        Err(e) => {
            let problem = format!("{} (values are written as in the scene file)", e.message());
            return Err(Error::Syntax { place, problem });
        }
    };
    let mut node = Node {
        value,
        key: place.clone(),
        place,
    };
    node.move_to(&node.place.clone());
    Ok(node)
}

impl Node {
    /// Says of the whole tree that it is written at `place`.
    fn move_to(&mut self, place: &Place) {
        self.place = place.clone();
        self.key = place.clone();
        match &mut self.value {
            Value::Array(nodes) => nodes.iter_mut().for_each(|n| n.move_to(place)),
            Value::Table(nodes) => nodes.values_mut().for_each(|n| n.move_to(place)),
            _ => {}
        }
    }
}

/// A text, and what its lines and columns are counted by.
struct Source {
    path: Arc<str>,
    text: Arc<str>,
    /// Where lines start.
    lines: Vec<usize>,
    /// Bytes that start no character.
    continuations: Vec<usize>,
}

impl Source {
    fn new(path: &str, text: &str) -> Self {
        let ends = text.match_indices('\n').map(|(i, _)| i + 1);
        Self {
            path: path.into(),
            text: text.into(),
            lines: [0].into_iter().chain(ends).collect(),
            continuations: (0..text.len())
                .filter(|&i| !text.is_char_boundary(i))
                .collect(),
        }
    }

    fn place(&self, span: &Range<usize>) -> Place {
        let at = span.start;
        let line = self.lines.partition_point(|&start| start <= at);
        let start = self.lines[line - 1];
        let inner = |end: usize| self.continuations.partition_point(|&i| i < end);
        Place::File {
            path: self.path.clone(),
            line,
            column: at - start - (inner(at) - inner(start)) + 1,
            text: self.text.clone(),
            span: span.clone(),
        }
    }

    fn table(&self, table: DeTable<'_>) -> Result<Value, Error> {
        let entries = table.into_iter().map(|(key, value)| {
            let node = self.node(value, self.place(&key.span()))?;
            Ok((key.into_inner().into_owned(), node))
        });
        Ok(Value::Table(entries.collect::<Result<_, Error>>()?))
    }

    fn node(&self, value: Spanned<DeValue<'_>>, key: Place) -> Result<Node, Error> {
        let place = self.place(&value.span());
        let too_large = |text: &str| Error::Syntax {
            place: place.clone(),
            problem: format!("{text} does not fit into 64 bits: write a smaller number"),
        };
        let value = match value.into_inner() {
            DeValue::String(s) => Value::String(s.into_owned()),
            DeValue::Integer(i) => Value::Integer(
                i64::from_str_radix(i.as_str(), i.radix()).map_err(|_| too_large(i.as_str()))?,
            ),
            DeValue::Float(x) => {
                Value::Float(x.as_str().parse().map_err(|_| too_large(x.as_str()))?)
            }
            DeValue::Boolean(b) => Value::Bool(b),
            DeValue::Datetime(_) => Value::Date,
            DeValue::Table(t) => self.table(t)?,
            DeValue::Array(a) => {
                let nodes = a.into_iter().map(|element| {
                    let place = self.place(&element.span());
                    self.node(element, place)
                });
                Value::Array(nodes.collect::<Result<_, Error>>()?)
            }
        };
        Ok(Node { value, place, key })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters() {
        let text = "a = 1\n\"größe\" = [\"é\", 2]";
        let source = Source::new("x", text);
        let place = |part: &str| {
            let start = text.find(part).unwrap();
            source.place(&(start..start)).to_string()
        };
        let parts = ["a", "1", "\"gr", "[", "2"];
        assert_eq!(
            parts.map(place),
            ["x:1:1", "x:1:5", "x:2:1", "x:2:11", "x:2:17"]
        );
        assert_eq!(
            source.place(&(text.len()..text.len())).to_string(),
            "x:2:19"
        );
    }
}
