// Attachments as they are saved and set up again, and the events that they report.
#include <utility>

#include "lobe/error.h"
#include "lobe/forces/attachments.h"
#include "lobe/forces/saved_terms.h"
#include "lobe/text.h"

namespace lobe {

template <class Real>
std::string Attachments<Real>::save() const {
  io::ByteWriter out;
  io::put(out, state_);
  return out.bytes();
}

template <class Real>
void Attachments<Real>::load(const std::string& saved, Index) {
  io::ByteReader in("checkpoint", saved);
  State found;
  io::get(in, found);
  in.expect_end();
  for (const Attachment& attachment : found.attachments)
    in.expect(attachment.now.holds_until > 0 && attachment.now.softening > 1);
  state_ = std::move(found);
  is_arranged_ = has_torn_ = false;
}

template <class Real>
std::vector<AttachmentSetup> Attachments<Real>::as_setup() const {
  std::vector<AttachmentSetup> all;
  for (const Attachment& attachment : state_.attachments)
    if (!attachment.now.strands.empty()) all.push_back(attachment.now);
  return all;
}

template <class Real>
void Attachments<Real>::add_to_setup(const Elements&, const CompactMesh& left, Setup& setup) const {
  setup.attachments = as_setup();
  for (AttachmentSetup& attachment : setup.attachments)
    for (StrandSetup& strand : attachment.strands)
      for (EmbeddedPoint* end : {&strand.from, &strand.to})
        if (end->tet >= 0) end->tet = left.tet_target[end->tet];
}

// One event for all strands of an attachment that tore in a frame. People are told of the first and the last.
template <class Real>
std::vector<Event> Attachments<Real>::take_events() {
  std::vector<Event> events;
  for (Attachment& attachment : state_.attachments) {
    const StrandsGone torn = std::exchange(attachment.torn_since, {});
    const Vec3d places = std::exchange(attachment.places, Vec3d::Zero());
    if (torn.count == 0) continue;
    const std::string name = "attachment \"" + attachment.now.name + "\"",
                      area = rounded(1e6 * attachment.torn.area);
    std::string text;
    if (attachment.now.strands.empty())
      text = name + (attachment.torn.area > 0 ? " has torn off: " + area + " mm²" : " has torn");
    else if (attachment.torn.count == torn.count)
      text = name + " begins to tear";
    events.push_back(
        {Event::Kind::torn, attachment.last, Vec3d(places / torn.count), torn.area, std::move(text)});
  }
  return events;
}

}  // namespace lobe
