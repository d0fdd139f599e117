//! Which channels of an EXR file are what.

use exr::meta::header::Header;

/// Layers that are the picture itself, as renderers call them.
const PICTURES: [&str; 6] = ["combined", "beauty", "rgb", "rgba", "color", "colour"];

/// Layers that have colours and are not the picture.
const FEATURES: [&str; 2] = ["variance", "albedo"];

const RGB: [&str; 3] = ["R", "G", "B"];

/// A part of the file, and its channels by index.
pub(super) struct Selection {
    pub(super) part: usize,
    pub(super) radiance: Vec<usize>,
    pub(super) variance: Option<Vec<usize>>,
    pub(super) samples: Option<usize>,
    /// Albedo, normal, depth.
    pub(super) features: Option<[usize; 7]>,
}

/// A layer with colours: its part, and what stands before `R`, `G`, `B` or `Y` in their names.
struct Layer<'a> {
    part: usize,
    prefix: String,
    names: &'a [&'static str],
}

impl Selection {
    pub(super) fn of(headers: &[Header]) -> Result<Self, String> {
        let layer = picture(headers)?;
        let header = &headers[layer.part];
        let find = |layer: &str, names: &[&str]| -> Option<Vec<usize>> {
            let names = names.iter().map(|name| index(header, &join(layer, name)));
            names.collect()
        };
        let radiance = find(&layer.prefix, layer.names)
            .ok_or("its channels are not those that its header lists")?;
        Ok(Self {
            part: layer.part,
            radiance,
            variance: find("variance", layer.names),
            samples: find("samples", &["Y"]).map(|channels| channels[0]),
            features: features(&find),
        })
    }

    /// All channels that are wanted.
    pub(super) fn channels(&self) -> impl Iterator<Item = usize> + '_ {
        let variance = self.variance.iter().flatten();
        let features = self.features.iter().flatten();
        let planes = self.radiance.iter().chain(variance).chain(features);
        planes.copied().chain(self.samples)
    }
}

/// The channels of all features, or none.
fn features(find: &impl Fn(&str, &[&str]) -> Option<Vec<usize>>) -> Option<[usize; 7]> {
    let layers = [
        find("albedo", &RGB)?,
        find("normal", &["X", "Y", "Z"])?,
        find("depth", &["Z"])?,
    ];
    layers.concat().try_into().ok()
}

/// The layer that is the picture.
fn picture(headers: &[Header]) -> Result<Layer<'_>, String> {
    let mut layers = coloured(headers, &RGB);
    layers.extend(coloured(headers, &["Y"]));
    layers.sort_by_key(|layer| rank(headers, layer));
    if layers
        .first()
        .is_some_and(|layer| chroma(&headers[layer.part], layer))
    {
        return Err("is a luminance beside chroma: write the picture as R, G, B".into());
    }
    let best = layers.first().map(|layer| rank(headers, layer));
    match (best, layers.len()) {
        (Some(0 | 1), _) | (_, 1) => Ok(layers.swap_remove(0)),
        (None, _) => Err(format!(
            "has no channels R, G, B and no Y, but {}: write the picture as R, G, B",
            listed(headers.iter().flat_map(names))
        )),
        _ => {
            let prefixes = layers.iter().map(|layer| {
                let part = part_name(&headers[layer.part]);
                join(&part, &layer.prefix).trim_end_matches('.').to_owned()
            });
            Err(format!(
                "the picture may be any of the layers {}: write it as R, G, B without a prefix",
                listed(prefixes)
            ))
        }
    }
}

/// Whether a grey layer has its colours in channels of differences.
fn chroma(header: &Header, layer: &Layer<'_>) -> bool {
    layer.names.len() == 1 && index(header, &join(&layer.prefix, "RY")).is_some()
}

/// 0 for a picture without a prefix, 1 for one called so, 2 for what may be one.
fn rank(headers: &[Header], layer: &Layer<'_>) -> u8 {
    let part = part_name(&headers[layer.part]);
    let called = |name: &str| {
        let last = name.rsplit('.').next().unwrap_or(name).to_lowercase();
        PICTURES.contains(&last.as_str())
    };
    match layer.prefix.as_str() {
        "" if headers.len() == 1 || part.is_empty() => 0,
        "" if called(&part) => 1,
        "" => 2,
        prefix if called(prefix) => 1,
        _ => 2,
    }
}

/// Empty if the part has none.
fn part_name(header: &Header) -> String {
    let name = &header.own_attributes.layer_name;
    name.as_ref().map(ToString::to_string).unwrap_or_default()
}

/// The layers that have all channels of these names.
fn coloured<'a>(headers: &[Header], channels: &'a [&'static str]) -> Vec<Layer<'a>> {
    let mut layers = Vec::new();
    for (part, header) in headers.iter().enumerate() {
        for name in names(header) {
            let prefix = match name.rsplit_once('.') {
                Some((prefix, last)) if last == channels[0] => prefix,
                None if name == channels[0] => "",
                _ => continue,
            };
            let has = |channel: &&str| index(header, &join(prefix, channel)).is_some();
            let grey_of_colours = channels.len() == 1 && RGB.iter().all(has);
            let feature = FEATURES.contains(&prefix) || prefix == "samples" || prefix == "normal";
            if channels.iter().all(has) && !grey_of_colours && !feature {
                layers.push(Layer {
                    part,
                    prefix: prefix.to_owned(),
                    names: channels,
                });
            }
        }
    }
    layers
}

fn names(header: &Header) -> impl Iterator<Item = String> + '_ {
    header.channels.list.iter().map(|c| c.name.to_string())
}

fn index(header: &Header, name: &str) -> Option<usize> {
    (header.channels.list.iter()).position(|channel| channel.name.eq(name))
}

fn join(layer: &str, channel: &str) -> String {
    if layer.is_empty() {
        channel.to_owned()
    } else {
        format!("{layer}.{channel}")
    }
}

/// The first few of the names, for a message.
fn listed(names: impl Iterator<Item = String>) -> String {
    const SHOWN: usize = 8;
    let names: Vec<_> = names.take(SHOWN + 1).collect();
    let more = if names.len() > SHOWN { ", …" } else { "" };
    let shown: Vec<_> = names.iter().take(SHOWN).map(|n| format!("`{n}`")).collect();
    format!("{}{more}", shown.join(", "))
}
