//! Asks a tree for keys by name, type and range, and reports the keys that nobody asked for.

use super::document::{Node, Value};
use crate::error::{Error, Place};
use glam::DVec3;
use std::cell::RefCell;
use std::collections::BTreeMap;
use tyndall_core::Rgb;

/// A table being read.
pub(crate) struct Table<'a> {
    field: Field<'a>,
    entries: &'a BTreeMap<String, Node>,
    asked: RefCell<Vec<&'static str>>,
}

impl<'a> Table<'a> {
    /// Says that these keys will be asked for: they are no typos of one another.
    pub(crate) fn expect(&self, keys: &[&'static str]) {
        let mut asked = self.asked.borrow_mut();
        for key in keys {
            if !asked.contains(key) {
                asked.push(key);
            }
        }
    }

    /// The value of `key`, if there is one.
    pub(crate) fn optional(&self, key: &'static str) -> Option<Field<'a>> {
        self.expect(&[key]);
        self.entries
            .get(key)
            .map(|node| self.field.child(key, node))
    }

    /// The value of `key`.
    pub(crate) fn required(&self, key: &'static str) -> Result<Field<'a>, Error> {
        self.optional(key).ok_or_else(|| self.missing(key))
    }

    /// One of two keys, and whether it is the second.
    pub(crate) fn either(
        &self,
        first: &'static str,
        second: &'static str,
    ) -> Result<(Field<'a>, bool), Error> {
        match (self.optional(first), self.optional(second)) {
            (Some(field), None) => Ok((field, false)),
            (None, Some(field)) => Ok((field, true)),
            (Some(_), Some(both)) => Err(both.error(format!(
                "`{first}` and `{second}` exclude each other: remove one"
            ))),
            (None, None) => Err(self.missing(first)),
        }
    }

    /// All entries, for tables whose keys are names that the author chose.
    pub(crate) fn named(&self) -> impl Iterator<Item = (&'a str, Field<'a>)> {
        let field = &self.field;
        self.entries
            .iter()
            .map(move |(key, node)| (key.as_str(), field.child(key, node)))
    }

    /// The keys that are there, and where.
    pub(crate) fn keys(&self) -> impl Iterator<Item = (&'a str, &'a Place)> {
        self.entries
            .iter()
            .map(|(key, node)| (key.as_str(), &node.key))
    }

    /// The table itself, to complain about.
    pub(crate) fn field(&self) -> &Field<'a> {
        &self.field
    }

    /// Reports every key that was not asked for.
    pub(crate) fn finish(&self) -> Result<(), Error> {
        let asked = self.asked.borrow();
        let mut unknown: Vec<_> = (self.entries.iter())
            .filter(|(key, _)| !asked.contains(&key.as_str()))
            .map(|(key, node)| (key, node, self.nearest_known(key)))
            .collect();
        unknown.sort_by_key(|(_, node, _)| match &node.key {
            Place::File { line, column, .. } => (*line, *column),
            Place::Override(_) => (0, 0),
        });
        let Some((first, node, nearest)) = unknown.first() else {
            return Ok(());
        };
        let mut problem = format!("unknown key; {nearest}");
        for (key, node, nearest) in &unknown[1..] {
            let field = self.field.child_path(key);
            problem += &format!("\n{}: `{field}`: unknown key; {nearest}", node.key);
        }
        Err(Error::Scene {
            place: node.key.clone(),
            field: self.field.child_path(first),
            problem,
        })
    }

    fn nearest_known(&self, key: &str) -> String {
        let asked = self.asked.borrow();
        match nearest(key, asked.iter().copied()) {
            Some(known) => format!("did you mean `{known}`?"),
            None if asked.is_empty() => "remove it".into(),
            None => format!("known here: {}", list(asked.iter().copied())),
        }
    }

    /// A missing key, or a key so close to it that it was meant.
    fn missing(&self, key: &'static str) -> Error {
        let asked = self.asked.borrow();
        let strangers = self.entries.keys().map(String::as_str);
        match nearest(key, strangers.filter(|k| !asked.contains(k))) {
            Some(typo) => Error::Scene {
                place: self.entries[typo].key.clone(),
                field: self.field.child_path(typo),
                problem: format!("unknown key; did you mean `{key}`?"),
            },
            None => self.field.error(format!("`{key}` is missing: add it")),
        }
    }
}

/// A value being read, and its name.
#[derive(Clone)]
pub(crate) struct Field<'a> {
    node: &'a Node,
    path: String,
}

impl<'a> Field<'a> {
    /// The root of a file.
    pub(crate) fn root(node: &'a Node) -> Self {
        let path = String::new();
        Self { node, path }
    }

    fn child_path(&self, key: &str) -> String {
        match self.path.as_str() {
            "" => key.to_owned(),
            path => format!("{path}.{key}"),
        }
    }

    fn child(&self, key: &str, node: &'a Node) -> Self {
        let path = self.child_path(key);
        Self { node, path }
    }

    /// A complaint about this value.
    pub(crate) fn error(&self, problem: impl ToString) -> Error {
        let field = match self.path.as_str() {
            "" => "scene".to_owned(),
            path => path.to_owned(),
        };
        Error::Scene {
            place: self.node.place.clone(),
            field,
            problem: problem.to_string(),
        }
    }

    fn expected(&self, what: &str) -> Error {
        let found = self.node.value.describe();
        self.error(format!("expected {what}, found {found}"))
    }

    pub(crate) fn place(&self) -> Place {
        self.node.place.clone()
    }

    pub(crate) fn is_string(&self) -> bool {
        matches!(self.node.value, Value::String(_))
    }

    pub(crate) fn is_table(&self) -> bool {
        matches!(self.node.value, Value::Table(_))
    }

    pub(crate) fn is_array(&self) -> bool {
        matches!(self.node.value, Value::Array(_))
    }

    pub(crate) fn string(&self) -> Result<&'a str, Error> {
        match &self.node.value {
            Value::String(s) => Ok(s),
            _ => Err(self.expected("a string")),
        }
    }

    pub(crate) fn table(&self) -> Result<Table<'a>, Error> {
        match &self.node.value {
            Value::Table(entries) => Ok(Table {
                field: self.clone(),
                entries,
                asked: RefCell::default(),
            }),
            _ => Err(self.expected("a table")),
        }
    }

    pub(crate) fn elements(&self) -> Result<Vec<Field<'a>>, Error> {
        match &self.node.value {
            Value::Array(nodes) => Ok((nodes.iter().enumerate())
                .map(|(i, node)| self.child(&i.to_string(), node))
                .collect()),
            _ => Err(self.expected("an array")),
        }
    }

    pub(crate) fn boolean(&self) -> Result<bool, Error> {
        match self.node.value {
            Value::Bool(b) => Ok(b),
            _ => Err(self.expected("true or false")),
        }
    }

    /// A finite number.
    pub(crate) fn number(&self) -> Result<f64, Error> {
        let x = match self.node.value {
            Value::Integer(i) => i as f64,
            Value::Float(x) => x,
            _ => return Err(self.expected("a number")),
        };
        if !x.is_finite() || x.abs() > f64::from(f32::MAX) {
            return Err(self.expected("a finite number"));
        }
        Ok(x)
    }

    /// A number that is not negative.
    pub(crate) fn not_negative(&self) -> Result<f32, Error> {
        self.number_that(|x| x >= 0.0, "a number ≥ 0")
    }

    /// A number above zero.
    pub(crate) fn positive(&self) -> Result<f32, Error> {
        self.number_that(|x| x as f32 > 0.0, "a number > 0")
    }

    /// A number that passes `test`; `what` says so in words.
    pub(crate) fn number_that(&self, test: impl Fn(f64) -> bool, what: &str) -> Result<f32, Error> {
        let x = self.number()?;
        if test(x) {
            Ok(x as f32)
        } else {
            Err(self.expected(what))
        }
    }

    /// A whole number from `min` to `max`.
    pub(crate) fn integer(&self, min: i64, max: i64) -> Result<i64, Error> {
        match self.node.value {
            Value::Integer(i) if (min..=max).contains(&i) => Ok(i),
            _ => Err(self.expected(&format!("a whole number from {min} to {max}"))),
        }
    }

    /// `[x, y, z]`, finite.
    pub(crate) fn vector(&self) -> Result<DVec3, Error> {
        match self.elements().ok().as_deref() {
            Some([x, y, z]) => Ok(DVec3::new(x.number()?, y.number()?, z.number()?)),
            _ => Err(self.expected("an array of three numbers, [x, y, z]")),
        }
    }

    /// A vector that is not zero, made unit.
    pub(crate) fn direction(&self) -> Result<DVec3, Error> {
        (self.vector()?.try_normalize())
            .ok_or_else(|| self.expected("a vector other than [0, 0, 0]"))
    }

    /// A number or `[r, g, b]`, not negative.
    pub(crate) fn colour(&self) -> Result<Rgb, Error> {
        if !self.is_array() {
            let x = self.not_negative();
            return x
                .map(|x| Rgb::new(x, x, x))
                .map_err(|e| match self.number() {
                    Ok(_) => e,
                    Err(_) => self.expected("a finite number ≥ 0 or [r, g, b]"),
                });
        }
        match self.elements()?.as_slice() {
            [r, g, b] => Ok(Rgb::new(
                r.not_negative()?,
                g.not_negative()?,
                b.not_negative()?,
            )),
            _ => Err(self.expected("a number or [r, g, b]")),
        }
    }

    /// A colour whose channels are at most one.
    pub(crate) fn fraction(&self) -> Result<Rgb, Error> {
        self.colour_that(|x| x <= 1.0, "between 0 and 1")
    }

    /// A colour whose channels all pass `test`; `range` says so in words.
    pub(crate) fn colour_that(
        &self,
        test: impl Fn(f32) -> bool,
        range: &str,
    ) -> Result<Rgb, Error> {
        let colour = self.colour()?;
        if colour.0.to_array().into_iter().all(test) {
            Ok(colour)
        } else {
            Err(self.expected(&format!("a number or [r, g, b] {range}")))
        }
    }

    /// One of a list of words, as its place in the list.
    pub(crate) fn one_of(&self, words: &[&'static str]) -> Result<&'static str, Error> {
        let word = self.string()?;
        (words.iter().copied().find(|w| *w == word)).ok_or_else(|| self.unknown("value", words))
    }

    /// The place in `names` of the name that this value is; `what` the names are of.
    pub(crate) fn name_in(&self, what: &str, names: &[&str]) -> Result<usize, Error> {
        let name = self.string()?;
        (names.iter().position(|n| *n == name)).ok_or_else(|| self.unknown(what, names))
    }

    /// Complains if `name`, which is this value's key, is not known.
    pub(crate) fn check_name(&self, name: &str, what: &str, known: &[&str]) -> Result<(), Error> {
        if known.contains(&name) {
            Ok(())
        } else {
            Err(self.unknown_name(name, what, known))
        }
    }

    fn unknown(&self, what: &str, known: &[&str]) -> Error {
        self.unknown_name(self.string().unwrap_or_default(), what, known)
    }

    fn unknown_name(&self, found: &str, what: &str, known: &[&str]) -> Error {
        self.error(match nearest(found, known.iter().copied()) {
            Some(near) => format!("unknown {what} {found:?}; did you mean {near:?}?"),
            None if known.is_empty() => format!("unknown {what} {found:?}; the scene has none"),
            None => format!(
                "unknown {what} {found:?}; known: {}",
                list(known.iter().copied())
            ),
        })
    }
}

/// The known word that `word` most likely was meant to be.
pub(crate) fn nearest<'k>(word: &str, known: impl Iterator<Item = &'k str>) -> Option<&'k str> {
    known
        .filter(|k| !k.is_empty())
        .map(|k| (strsim::damerau_levenshtein(word, k), k))
        .filter(|(distance, k)| *distance <= (k.chars().count().max(3) / 3).min(3))
        .min()
        .map(|(_, k)| k)
}

fn list<'k>(words: impl Iterator<Item = &'k str>) -> String {
    let words: Vec<_> = words.map(|w| format!("`{w}`")).collect();
    words.join(", ")
}
