//! Graphs as files: GraphML, DOT, JSON.

use std::fmt::Write;

use serde_json::{Map, json};

use super::graph::{Attributes, Graph, Value};

/// What graphs are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Format {
    /// For Gephi, yEd, Cytoscape, networkx, igraph.
    Graphml,
    /// For pictures by Graphviz.
    Dot,
    /// Vertices and edges, as networkx has them in JSON.
    Json,
}

impl Format {
    /// How its files end.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Graphml => "graphml",
            Format::Dot => "dot",
            Format::Json => "json",
        }
    }

    /// A graph in this format.
    pub fn write(self, graph: &Graph) -> String {
        match self {
            Format::Graphml => graphml(graph),
            Format::Dot => dot(graph),
            Format::Json => json_text(graph),
        }
    }
}

/// The keys of GraphML for the attributes of all vertices or of all edges: in the order in which they first occur.
struct Keys<'a> {
    /// What they are for, which is also the first letter of their names.
    of: &'static str,
    known: Vec<(&'a str, &'static str)>,
}

impl<'a> Keys<'a> {
    fn new(of: &'static str, all: impl Iterator<Item = &'a Attributes>) -> Keys<'a> {
        let mut known: Vec<(&str, &str)> = Vec::new();
        for (name, value) in all.flatten() {
            if !known.iter().any(|(other, _)| other == name) {
                known.push((name, value.graphml_type()));
            }
        }
        Keys { of, known }
    }

    fn declare(&self, into: &mut String) {
        for (place, (name, kind)) in self.known.iter().enumerate() {
            let (of, letter) = (self.of, &self.of[..1]);
            let name = in_xml(name);
            line(
                into,
                format_args!("  <key id=\"{letter}{place}\" for=\"{of}\" attr.name=\"{name}\" attr.type=\"{kind}\"/>"),
            );
        }
    }

    /// The data of a vertex or of an edge.
    fn data(&self, attributes: &Attributes) -> String {
        let letter = &self.of[..1];
        let datum = |(name, value): &(String, Value)| {
            let place = self.known.iter().position(|(known, _)| known == name)?;
            Some(format!("<data key=\"{letter}{place}\">{}</data>", in_xml(&value.plain())))
        };
        attributes.iter().filter_map(datum).collect()
    }
}

impl Value {
    fn graphml_type(&self) -> &'static str {
        match self {
            Value::Whole(_) => "long",
            Value::Number(_) => "double",
            Value::Text(_) => "string",
            Value::Truth(_) => "boolean",
        }
    }

    fn plain(&self) -> String {
        match self {
            Value::Whole(count) => count.to_string(),
            Value::Number(measure) => format!("{measure:?}"),
            Value::Text(text) => text.clone(),
            Value::Truth(truth) => truth.to_string(),
        }
    }

    fn json(&self) -> serde_json::Value {
        match self {
            Value::Whole(count) => (*count).into(),
            Value::Number(measure) => (*measure).into(),
            Value::Text(text) => text.as_str().into(),
            Value::Truth(truth) => (*truth).into(),
        }
    }
}

/// Adds a line to a text. (To a text in memory everything can be written.)
fn line(into: &mut String, text: std::fmt::Arguments<'_>) {
    let _ = writeln!(into, "{text}");
}

fn in_xml(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn graphml(graph: &Graph) -> String {
    let vertices = Keys::new("node", graph.vertices.iter().map(|vertex| &vertex.attributes));
    let edges = Keys::new("edge", graph.edges.iter().map(|edge| &edge.attributes));
    let mut file = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    line(&mut file, format_args!("<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">"));
    vertices.declare(&mut file);
    edges.declare(&mut file);
    line(&mut file, format_args!("  <graph id=\"{}\" edgedefault=\"directed\">", graph.name));
    for vertex in &graph.vertices {
        let (id, data) = (in_xml(&vertex.id), vertices.data(&vertex.attributes));
        line(&mut file, format_args!("    <node id=\"{id}\">{data}</node>"));
    }
    for edge in &graph.edges {
        let [from, to] = [edge.from, edge.to].map(|place| in_xml(&graph.vertices[place].id));
        let data = edges.data(&edge.attributes);
        line(&mut file, format_args!("    <edge source=\"{from}\" target=\"{to}\">{data}</edge>"));
    }
    file + "  </graph>\n</graphml>\n"
}

/// A text between quotation marks, as DOT has it.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

fn dot(graph: &Graph) -> String {
    let list = |attributes: &Attributes| {
        let all: Vec<String> =
            attributes.iter().map(|(name, value)| format!("{}={}", quoted(name), quoted(&value.plain()))).collect();
        if all.is_empty() { String::new() } else { format!(" [{}]", all.join(", ")) }
    };
    let mut file = format!("digraph {} {{\n", quoted(graph.name));
    for vertex in &graph.vertices {
        line(&mut file, format_args!("  {}{};", quoted(&vertex.id), list(&vertex.attributes)));
    }
    for edge in &graph.edges {
        let [from, to] = [edge.from, edge.to].map(|place| quoted(&graph.vertices[place].id));
        line(&mut file, format_args!("  {from} -> {to}{};", list(&edge.attributes)));
    }
    file + "}\n"
}

fn json_text(graph: &Graph) -> String {
    let with = |head: &[(&str, &str)], attributes: &Attributes| {
        let head = head.iter().map(|(name, id)| ((*name).to_owned(), (*id).into()));
        let all = attributes.iter().map(|(name, value)| (name.clone(), value.json()));
        serde_json::Value::Object(head.chain(all).collect::<Map<_, _>>())
    };
    let mut pairs: Vec<(usize, usize)> = graph.edges.iter().map(|edge| (edge.from, edge.to)).collect();
    pairs.sort_unstable();
    let nodes: Vec<_> = graph.vertices.iter().map(|vertex| with(&[("id", &vertex.id)], &vertex.attributes)).collect();
    let id = |place: usize| graph.vertices[place].id.as_str();
    let edges: Vec<_> = graph
        .edges
        .iter()
        .map(|edge| with(&[("source", id(edge.from)), ("target", id(edge.to))], &edge.attributes))
        .collect();
    let all = json!({
        "directed": true,
        "multigraph": pairs.windows(2).any(|pair| pair[0] == pair[1]),
        "graph": {"name": graph.name},
        "nodes": nodes,
        "edges": edges,
    });
    format!("{all:#}\n")
}

#[cfg(test)]
mod tests {
    use super::super::graph::{number, text, whole};
    use super::*;

    fn small() -> Graph {
        let mut graph = Graph::new("G_p");
        let a = graph.add_vertex("a".into(), vec![text("label", "a \"<&>\" \\"), whole("words", 7)]);
        let b = graph.add_vertex("b".into(), vec![number("share", 0.1), ("busy".into(), Value::Truth(true))]);
        graph.add_edge(a, b, vec![text("label", "east")]);
        graph.add_edge(a, b, Vec::new());
        graph
    }

    #[test]
    fn signs_that_mean_something_are_written_so_that_they_mean_themselves() {
        let graphml = Format::Graphml.write(&small());
        assert!(graphml.contains("<data key=\"n0\">a &quot;&lt;&amp;&gt;&quot; \\</data><data key=\"n1\">7</data>"));
        let dot = Format::Dot.write(&small());
        assert!(dot.contains(r#""a" ["label"="a \"<&>\" \\", "words"="7"];"#), "{dot}");
        let json: serde_json::Value = serde_json::from_str(&Format::Json.write(&small())).unwrap();
        assert_eq!(json["nodes"][0]["label"], "a \"<&>\" \\");
        assert_eq!((&json["nodes"][1]["share"], &json["nodes"][1]["busy"]), (&json!(0.1), &json!(true)));
    }

    #[test]
    fn parallel_edges_are_told_to_who_would_keep_one_of_them() {
        let read = |graph: &Graph| serde_json::from_str::<serde_json::Value>(&Format::Json.write(graph)).unwrap();
        let mut graph = small();
        assert_eq!(read(&graph)["multigraph"], true);
        graph.edges.pop();
        assert_eq!(read(&graph)["multigraph"], false);
    }
}
